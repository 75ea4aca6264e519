// Contact impulses of a time step, in all lanes: block Gauss-Seidel over contact points with
// Coulomb's cone, fingers' self contacts, and the servos' torque and angle limits.
#if defined(DEXREMOE_LANE_SOLVER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DEXREMOE_LANE_SOLVER_INL_H
#undef DEXREMOE_LANE_SOLVER_INL_H
#else
#define DEXREMOE_LANE_SOLVER_INL_H
#endif

#include "sim/lanes/lane_self_contacts-inl.h"
#include "sim/lanes/lane_spin-inl.h"

HWY_BEFORE_NAMESPACE();
namespace dexremoe {
namespace HWY_NAMESPACE {

// Overlap up to kSlop is left alone; beyond it a share kErp is corrected in a time step, at most
// this fast.
constexpr float kSlop = 3e-4f;          // m
constexpr float kErp = 0.2f;            // 1
constexpr float kMaxCorrection = 1.0f;  // m/s
// Added to a row's inverse mass: keeps rows that meet the same bodies solvable. (The object's own
// share is above 5 / kg.)
constexpr float kSoftness = 1e-2f;  // 1 / kg
// Below this inverse mass neither side can move.
constexpr float kImmovable = 1e-6f;  // 1 / kg
constexpr float kNoForce = 1e-4f;    // N

// Normal velocity that a contact asks for at the end of a time step.
HWY_INLINE F SeparationSpeed(F gap, F rate) {
  const F correction = Max(Min(gap + F(kSlop), F(0.0f)) * F(kErp) * rate, F(-kMaxCorrection));
  return Select(gap > F(0.0f), gap * rate, correction);
}

// Three rows of a contact: along the normal and two tangents. A row's velocity is that of the hand
// against the object: hand[r] . u + object's lin[r] . vs + ang[r] . ws.
struct ContactRows {
  F hand[3][kMaxChainJoints];
  V3 lin[3], ang[3];
  V3 tangent[2];  // W
  // Of the matrix of the rows' inverse masses: the inverse of its normal entry; its column below
  // the normal; the inverse of its tangential block (11, 22, 12); the inverse of that block's
  // larger eigenvalue. All 0 in lanes without this point.
  F normal, lean[2], stick[3], slip;
  F gap, ask;    // m; -SeparationSpeed
  F impulse[3];  // N s
  SpinRow spin;  // set up for soft fingers only
};

// Two unit vectors that complete n to a right-handed frame (Duff et al., "Building an Orthonormal
// Basis, Revisited", JCGT 2017).
HWY_INLINE void Complete(const V3& n, V3& b1, V3& b2) {
  const F sign = Select(n.z < F(0.0f), F(-1.0f), F(1.0f));
  const F a = -Reciprocal(sign + n.z), b = n.x * n.y * a;
  b1 = {F(1.0f) + sign * n.x * n.x * a, sign * b, -sign * n.x};
  b2 = {b, sign + n.y * n.y * a, -n.y};
}

// L^-1 J^T of a unit force along `direction` at `point` on the chain's link `link` (per lane).
template <int N>
HWY_INLINE void ChainRow(const HandState& hand, int first, const F* inverse, const V3& point,
                         F link, const V3& direction, F* row) {
  F j[N + 1];
  for (int i = 0; i < N; ++i) {
    const V3 lever = Cross(hand.R[first + i].z, point - hand.origin[first + i]);
    j[i] = OrZero(link >= F(static_cast<float>(i)), Dot(direction, lever));
  }
  WhitenedRow<N>(inverse, j, row);
}

template <int N>
HWY_INLINE F RowProduct(const ContactRows& rows, int a, int b) {
  F sum = Dot(rows.lin[a], rows.lin[b]) + Dot(rows.ang[a], rows.ang[b]);
  for (int i = 0; i < N; ++i) sum += rows.hand[a][i] * rows.hand[b][i];
  return sum;
}

// Impulses of the last substep for the same core and start.
HWY_INLINE void Inherit(const BlockLayout& at, const float* block, int group, F key, M here,
                        ContactRows& rows) {
  V3 friction = {F(0.0f), F(0.0f), F(0.0f)};
  F normal(0.0f), spin(0.0f);
  for (int k = 0; k < kSlots; ++k) {
    const float* old = block + at.Contact(group, k) * kBlockLanes;
    const M same = And(here, Load(old) == key);
    if (!Any(same)) continue;
    normal = Select(same, Load(old + kBlockLanes), normal);
    friction = Select(same, LoadV3(old + 2 * kBlockLanes), friction);
    spin = Select(same, Load(old + 5 * kBlockLanes), spin);
  }
  rows.impulse[0] = normal;
  rows.impulse[1] = Dot(friction, rows.tangent[0]);
  rows.impulse[2] = Dot(friction, rows.tangent[1]);
  rows.spin.impulse = spin;
}

template <int N>
HWY_NOINLINE void SetUpContact(int group, int first, const Contacts& found, int k,
                               const HandState& hand, const ObjectState& object, bool soft,
                               ContactRows& rows) {
  const V3& point = found.point[k];
  const M here = found.count > F(static_cast<float>(k));
  Complete(found.normal[k], rows.tangent[0], rows.tangent[1]);
  const V3 direction[3] = {found.normal[k], rows.tangent[0], rows.tangent[1]};
  const V3 arm = Back(object.R, point - object.x);
  for (int r = 0; r < 3; ++r) {
    ChainRow<N>(hand, first, hand.inverse[group], point, found.link[k], direction[r], rows.hand[r]);
    rows.lin[r] = direction[r] * -object.s_mass;
    const V3 moment = Cross(Back(object.R, direction[r]), arm);  // of the reaction on the object
    rows.ang[r] = Times(moment, object.s_inertia);
  }
  const F nn = RowProduct<N>(rows, 0, 0), n1 = RowProduct<N>(rows, 1, 0),
          n2 = RowProduct<N>(rows, 2, 0), t12 = RowProduct<N>(rows, 2, 1),
          t11 = RowProduct<N>(rows, 1, 1) + F(kSoftness),
          t22 = RowProduct<N>(rows, 2, 2) + F(kSoftness);
  const M moves = And(here, nn > F(kImmovable));
  rows.normal = OrZero(moves, Reciprocal(nn + F(kSoftness)));
  rows.lean[0] = OrZero(moves, n1);
  rows.lean[1] = OrZero(moves, n2);
  const F determinant = OrZero(moves, Reciprocal(t11 * t22 - t12 * t12));
  rows.stick[0] = t22 * determinant;
  rows.stick[1] = t11 * determinant;
  rows.stick[2] = -t12 * determinant;
  const F mean = F(0.5f) * (t11 + t22), half = F(0.5f) * (t11 - t22);
  rows.slip = OrZero(moves, RoughReciprocal(mean + Sqrt(half * half + t12 * t12)));
  rows.gap = found.gap[k];
  if (soft) SetUpSpin<N>(group, first, found, k, hand, object, rows.spin);
}

// What a contact acts on: one chain's whitened velocity and the object's. Copied out of the state
// for a chain's contacts, so that they stay in registers.
template <int N>
struct Velocity {
  F u[N + 1];
  V3 vs, ws;

  HWY_INLINE Velocity(const F* chain, const ObjectState& object) : vs(object.vs), ws(object.ws) {
    for (int i = 0; i < N; ++i) u[i] = chain[i];
  }
  HWY_INLINE void Return(F* chain, ObjectState& object) const {
    for (int i = 0; i < N; ++i) chain[i] = u[i];
    object.vs = vs;
    object.ws = ws;
  }
  HWY_INLINE void Add(const ContactRows& rows, int r, F impulse) {
    for (int i = 0; i < N; ++i) u[i] += rows.hand[r][i] * impulse;
    vs = vs + rows.lin[r] * impulse;
    ws = ws + rows.ang[r] * impulse;
  }
  HWY_INLINE F Along(const ContactRows& rows, int r) const {
    const V3 &lin = rows.lin[r], &ang = rows.ang[r];
    F a = lin.x * vs.x, b = ang.x * ws.x;
    for (int i = 0; i < N; ++i) (i % 2 ? b : a) += rows.hand[r][i] * u[i];
    a = a + lin.y * vs.y + lin.z * vs.z;
    b = b + ang.y * ws.y + ang.z * ws.z;
    return a + b;
  }
  HWY_INLINE void Add(const SpinRow& row, F impulse) {
    for (int i = 0; i < N; ++i) u[i] += row.hand[i] * impulse;
    ws = ws + row.object * impulse;
  }
  HWY_INLINE F Along(const SpinRow& row) const {
    F sum = Dot(row.object, ws);
    for (int i = 0; i < N; ++i) sum += row.hand[i] * u[i];
    return sum;
  }
};

// The normal impulse first, the tangential ones with it known. They stop the point if the cone has
// room for that; else they are moved against the slip, by the same factor in all directions, and
// back onto the cone, which settles where friction opposes the slip.
template <int N>
HWY_INLINE void SolveContact(ContactRows& rows, F friction, Velocity<N>& velocity) {
  const F s0 = velocity.Along(rows, 0), s1 = velocity.Along(rows, 1), s2 = velocity.Along(rows, 2);
  const F normal = Max(F(0.0f), rows.impulse[0] - rows.normal * (s0 + rows.ask));
  const F change = normal - rows.impulse[0];
  velocity.Add(rows, 0, change);
  const F v1 = s1 + rows.lean[0] * change, v2 = s2 + rows.lean[1] * change;
  const F most = friction * normal, most2 = most * most;
  const F stick1 = rows.impulse[1] - rows.stick[0] * v1 - rows.stick[2] * v2;
  const F stick2 = rows.impulse[2] - rows.stick[2] * v1 - rows.stick[1] * v2;
  const F slip1 = rows.impulse[1] - rows.slip * v1, slip2 = rows.impulse[2] - rows.slip * v2;
  const F shrink = Min(F(1.0f), most * RoughInverseSqrt(slip1 * slip1 + slip2 * slip2 + F(1e-20f)));
  const M sticks = stick1 * stick1 + stick2 * stick2 <= most2;
  const F t1 = Select(sticks, stick1, slip1 * shrink), t2 = Select(sticks, stick2, slip2 * shrink);
  velocity.Add(rows, 1, t1 - rows.impulse[1]);
  velocity.Add(rows, 2, t2 - rows.impulse[2]);
  rows.impulse[0] = normal;
  rows.impulse[1] = t1;
  rows.impulse[2] = t2;
}

// Stops the spin at a contact, as far as the tangential impulses leave it room in an ellipsoid of
// friction (see EnvPhysics::torsional_friction).
template <int N>
HWY_INLINE void SolveSpin(ContactRows& rows, const Friction& friction, Velocity<N>& velocity) {
  SpinRow& row = rows.spin;
  const F t1 = rows.impulse[1] * friction.inverse, t2 = rows.impulse[2] * friction.inverse;
  const F left = rows.impulse[0] * rows.impulse[0] - t1 * t1 - t2 * t2;
  const F most = friction.torsion * Sqrt(Max(left, F(0.0f)));
  const F impulse = Clamp(row.impulse - row.inverse * velocity.Along(row), -most, most);
  velocity.Add(row, impulse - row.impulse);
  row.impulse = impulse;
}

// Corrections of the servos' impulses so that torque and angle keep their limits. `spent` holds
// the corrections so far, one per joint.
template <int N>
HWY_INLINE void LimitJoints(const LanesModel& model, int c, F h, HandState& s, F* spent) {
  const int first = model.chains[c].first;
  const F* inverse = s.inverse[c];
  const F damping = h * s.damping;
  F* u = s.u + first;
  for (int i = 0; i < N; ++i) {
    const int j = first + i;
    const F most = h * F(model.links[j].torque_limit);
    // Without the correction: speed and servo impulse.
    const F speed = JointSpeed<N>(inverse, u, i) - s.give[j] * spent[j];
    const F servo = s.ask[j] - damping * speed;
    F correction = (Clamp(servo, -most, most) - servo) * s.relief[j];
    const F limited = speed + s.give[j] * correction;
    const F within = Clamp(limited, s.slowest[j], s.fastest[j]);
    correction += (within - limited) * s.stiff[j];
    const F change = correction - spent[j];
    spent[j] = correction;
    for (int n = i; n < N; ++n) u[n] += inverse[Packed(n, i)] * change;
  }
}

// The row of a self contact: keeps two chains, or a chain and the palm, apart; no friction.
struct SelfRow {
  int first[2], size[2];
  F hand[2][kMaxChainJoints];
  F inverse, gap, ask, impulse;
};

HWY_INLINE SelfRow SetUpSelf(const LanesModel& model, const SelfContact& contact,
                             const HandState& hand) {
  SelfRow row;
  const int chain[2] = {contact.chain_a, contact.chain_b};
  const F link[2] = {contact.link_a, contact.link_b};
  F mass(0.0f);
  for (int side = 0; side < 2; ++side) {
    const bool moves = chain[side] >= 0;
    row.first[side] = moves ? model.chains[chain[side]].first : 0;
    row.size[side] = moves ? model.chains[chain[side]].size : 0;
    const V3 direction = side == 0 ? contact.normal : contact.normal * F(-1.0f);
    WithSize(row.size[side], [&](auto n) HWY_ATTR {
      ChainRow<decltype(n)::value>(hand, row.first[side], hand.inverse[moves ? chain[side] : 0],
                                   contact.point, link[side], direction, row.hand[side]);
    });
    for (int i = 0; i < row.size[side]; ++i) mass += row.hand[side][i] * row.hand[side][i];
  }
  row.gap = contact.gap;
  row.inverse = OrZero(And(mass > F(kImmovable), contact.gap < F(2 * kForceReach)),
                       Reciprocal(mass + F(kSoftness)));
  return row;
}

HWY_INLINE F SelfSpeed(const SelfRow& row, const F* u) {
  F speed(0.0f);
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < row.size[side]; ++i) speed += row.hand[side][i] * u[row.first[side] + i];
  return speed;
}

HWY_INLINE void SolveSelf(SelfRow& row, F* u) {
  const F impulse = Max(F(0.0f), row.impulse - row.inverse * (SelfSpeed(row, u) + row.ask));
  const F change = impulse - row.impulse;
  row.impulse = impulse;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < row.size[side]; ++i) u[row.first[side] + i] += row.hand[side][i] * change;
}

}  // namespace HWY_NAMESPACE
}  // namespace dexremoe
HWY_AFTER_NAMESPACE();

#endif
