// Free motion of the hand's chains and of the object, in all lanes.
//
// Velocities are whitened, so that every body has unit mass in the solver. A chain with mass matrix
// M, rotor inertia A and implicit servo damping D = kd + h kp moves by
//   (M + A + h D) qd' = (M + A) qd + h (bias + kp (target - q)) + J^T impulse.
// With the Cholesky factor L L^T = M + A + h D and u = L^T qd an impulse along row j of J changes u
// by L^-1 j^T. The object's are root_mass v and root_inertia w, the latter in B.
#if defined(DEXREMOE_LANE_DYNAMICS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DEXREMOE_LANE_DYNAMICS_INL_H
#undef DEXREMOE_LANE_DYNAMICS_INL_H
#else
#define DEXREMOE_LANE_DYNAMICS_INL_H
#endif

#include <type_traits>

#include "sim/lanes/lane_math-inl.h"
#include "sim/lanes/lanes_model.h"

HWY_BEFORE_NAMESPACE();
namespace dexremoe {
namespace HWY_NAMESPACE {

// Index of entry (row, column <= row) in a packed lower triangle.
constexpr int Packed(int row, int column) { return row * (row + 1) / 2 + column; }
constexpr int kPackedSize = Packed(kMaxChainJoints, 0);

// Calls fn with size as a compile-time constant.
template <class Fn>
HWY_INLINE void WithSize(int size, Fn&& fn) {
  switch (size) {
    case 0:
      return fn(std::integral_constant<int, 0>());
    case 1:
      return fn(std::integral_constant<int, 1>());
    case 2:
      return fn(std::integral_constant<int, 2>());
    case 3:
      return fn(std::integral_constant<int, 3>());
    case 4:
      return fn(std::integral_constant<int, 4>());
    case 5:
      return fn(std::integral_constant<int, 5>());
    default:
      return fn(std::integral_constant<int, kMaxChainJoints>());
  }
}

// The hand during a substep. Per link, in W: joint origin and axes of L, velocity of the origin,
// angular velocity. Joint axes are R.z.
struct HandState {
  V3 origin[kMaxJoints], velocity[kMaxJoints], omega[kMaxJoints];
  Rotation R[kMaxJoints];
  F q[kMaxJoints], qd[kMaxJoints], target[kMaxJoints];
  F bias[kMaxJoints];                  // torque of gravity and motion; N m
  F u[kMaxJoints];                     // whitened velocity
  F inverse[kMaxChains][kPackedSize];  // L^-1
  // The servo's row on each joint: inverse inertia, its reciprocal, and that of 1 - h D times it.
  F give[kMaxJoints], stiff[kMaxJoints], relief[kMaxJoints];
  // Speeds at which a joint reaches its limits in a time step; rad/s.
  F slowest[kMaxJoints], fastest[kMaxJoints];
  F ask[kMaxJoints];  // the servo's impulse at zero speed: h kp e; N m s
  F kp, damping;      // servo gain; D
};

struct ObjectState {
  Rotation R;  // R_WB
  V3 x, v, w;  // of the centre of mass, W, at the start of the substep
  V3 com;      // in B
  F s_mass;    // 1 / root_mass, 0 while held
  V3 s_inertia;
  V3 vs, ws;  // whitened velocities: W and B
  V3 pull;    // change of vs in a time step: gravity and push
};

// I a for a symmetric matrix given by xx yy zz xy xz yz.
HWY_INLINE V3 Inertia(const float* I, const V3& a) {
  return {F(I[0]) * a.x + F(I[3]) * a.y + F(I[4]) * a.z,
          F(I[3]) * a.x + F(I[1]) * a.y + F(I[5]) * a.z,
          F(I[4]) * a.x + F(I[5]) * a.y + F(I[2]) * a.z};
}

// Pose of link `i` from its parent's, R_parent null at the base.
HWY_INLINE void PlaceLink(const LaneLink& link, const Rotation* R_parent, const V3& o_parent, int i,
                          HandState& s) {
  const V3 x = Everywhere(link.R_PL), y = Everywhere(link.R_PL + 3), z = Everywhere(link.R_PL + 6);
  const V3 p = Everywhere(link.p_PL);
  const auto [sine, cosine] = SinCos(s.q[i]);
  const V3 turned_x = x * cosine + y * sine, turned_y = y * cosine - x * sine;
  if (R_parent == nullptr) {
    s.origin[i] = p;
    s.R[i] = {turned_x, turned_y, z};
  } else {
    s.origin[i] = o_parent + *R_parent * p;
    s.R[i] = {*R_parent * turned_x, *R_parent * turned_y, *R_parent * z};
  }
}

// Poses and velocities of a chain, its mass matrix (packed) and bias torques: recursive
// Newton-Euler outwards with zero joint accelerations, and the sum over links of m Jv^T Jv + Jw^T I
// Jw (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 5 and 6).
template <int N>
HWY_INLINE void MoveChain(const LanesModel& model, int first, const V3& gravity, HandState& s,
                          F* mass) {
  for (int k = 0; k < Packed(N, 0); ++k) mass[k] = F(0.0f);
  V3 omega = {F(0.0f), F(0.0f), F(0.0f)}, alpha = omega, a_origin = omega, velocity = omega;
  for (int l = 0; l < N; ++l) {
    const int i = first + l;
    const LaneLink& link = model.links[i];
    PlaceLink(link, l == 0 ? nullptr : &s.R[i - 1], l == 0 ? s.origin[i] : s.origin[i - 1], i, s);
    const Rotation& R = s.R[i];
    if (l > 0) {
      const V3 arm = s.origin[i] - s.origin[i - 1], swing = Cross(omega, arm);
      velocity = velocity + swing;
      a_origin = a_origin + Cross(alpha, arm) + Cross(omega, swing);
    }
    const V3 spin = R.z * s.qd[i];
    alpha = alpha + Cross(omega, spin);
    omega = omega + spin;
    s.velocity[i] = velocity;
    s.omega[i] = omega;
    const V3 arm = R * Everywhere(link.com), com = s.origin[i] + arm;
    const V3 a_com = a_origin + Cross(alpha, arm) + Cross(omega, Cross(omega, arm));
    const F m(link.mass);
    const V3 force = (gravity - a_com) * m;
    const V3 w_L = Back(R, omega);
    const V3 torque =
        R * (Inertia(link.inertia, Back(R, alpha)) + Cross(w_L, Inertia(link.inertia, w_L)));
    V3 jv[N], jw[N];
    for (int k = 0; k <= l; ++k) {
      const V3& axis = s.R[first + k].z;
      const V3 r = com - s.origin[first + k];
      jv[k] = Cross(axis, r);
      // The link's own axis is its z.
      jw[k] = k == l ? V3{F(0.0f), F(0.0f), F(1.0f)} : Back(R, axis);
      const V3 Iw = k == l ? V3{F(link.inertia[4]), F(link.inertia[5]), F(link.inertia[2])}
                           : Inertia(link.inertia, jw[k]);
      const F load = Dot(jv[k], force) - Dot(axis, torque);
      s.bias[first + k] = k == l ? load : s.bias[first + k] + load;
      for (int n = 0; n <= k; ++n) mass[Packed(k, n)] += m * Dot(jv[k], jv[n]) + Dot(Iw, jw[n]);
    }
  }
}

// L^-1 of the matrix L L^T = a, and u = L^T qd.
template <int N>
HWY_INLINE void Whiten(const F* a, const F* qd, F* inverse, F* u) {
  F L[Packed(N, 0) + 1], reciprocal[N + 1];
  for (int i = 0; i < N; ++i)
    for (int k = 0; k <= i; ++k) {
      F sum = a[Packed(i, k)];
      for (int n = 0; n < k; ++n) sum -= L[Packed(i, n)] * L[Packed(k, n)];
      if (k == i) reciprocal[i] = InverseSqrt(sum);
      L[Packed(i, k)] = sum * reciprocal[k];
    }
  for (int k = 0; k < N; ++k) {
    inverse[Packed(k, k)] = reciprocal[k];
    for (int i = k + 1; i < N; ++i) {
      F sum(0.0f);
      for (int n = k; n < i; ++n) sum -= L[Packed(i, n)] * inverse[Packed(n, k)];
      inverse[Packed(i, k)] = sum * reciprocal[i];
    }
  }
  for (int i = 0; i < N; ++i) {
    u[i] = F(0.0f);
    for (int n = i; n < N; ++n) u[i] += L[Packed(n, i)] * qd[n];
  }
}

// L^-1 j: a row of a chain's Jacobian in whitened velocities.
template <int N>
HWY_INLINE void WhitenedRow(const F* inverse, const F* j, F* row) {
  for (int i = 0; i < N; ++i) {
    row[i] = F(0.0f);
    for (int n = 0; n <= i; ++n) row[i] += inverse[Packed(i, n)] * j[n];
  }
}

// Joint velocity i of a chain: row i of L^-T u.
template <int N>
HWY_INLINE F JointSpeed(const F* inverse, const F* u, int i) {
  F sum(0.0f);
  for (int n = i; n < N; ++n) sum += inverse[Packed(n, i)] * u[n];
  return sum;
}

template <int N>
HWY_NOINLINE void StartChain(const LanesModel& model, int c, const V3& gravity, F h, HandState& s) {
  const int first = model.chains[c].first;
  F mass[Packed(N, 0) + 1];
  MoveChain<N>(model, first, gravity, s, mass);
  for (int i = 0; i < N; ++i) mass[Packed(i, i)] += h * s.damping + F(model.armature);
  F* inverse = s.inverse[c];
  Whiten<N>(mass, s.qd + first, inverse, s.u + first);
  for (int i = 0; i < N; ++i) {
    F give(0.0f);
    for (int n = i; n < N; ++n) give += inverse[Packed(n, i)] * inverse[Packed(n, i)];
    s.give[first + i] = give;
    s.stiff[first + i] = Reciprocal(give);
    s.relief[first + i] = Reciprocal(F(1.0f) - h * s.damping * give);
  }
}

// What the servo of joint i asks for at zero speed, as an impulse: h kp e, with the error bounded
// so that the servo does not push beyond the speed limit.
HWY_INLINE F Ask(const LaneLink& link, const HandState& s, F h, int i) {
  const F most = F(link.speed_limit) * s.damping;
  return h * Clamp(s.kp * (s.target[i] - s.q[i]), -most, most);
}

// Adds servo and bias impulses of a time step to u.
template <int N>
HWY_INLINE void DriveChain(const LanesModel& model, int c, F h, F rate, HandState& s) {
  const int first = model.chains[c].first;
  F impulse[N + 1];
  for (int i = 0; i < N; ++i) {
    const int j = first + i;
    s.slowest[j] = (F(model.links[j].lower) - s.q[j]) * rate;
    s.fastest[j] = (F(model.links[j].upper) - s.q[j]) * rate;
    s.ask[j] = Ask(model.links[j], s, h, j);
    impulse[i] = h * s.bias[j] + s.ask[j] - h * s.damping * s.qd[j];
  }
  const F* inverse = s.inverse[c];
  for (int i = 0; i < N; ++i)
    for (int n = 0; n <= i; ++n) s.u[first + i] += inverse[Packed(i, n)] * impulse[n];
}

template <int N>
HWY_INLINE void FinishChain(const LanesModel& model, int c, F h, HandState& s) {
  const int first = model.chains[c].first;
  for (int i = 0; i < N; ++i) {
    const int j = first + i;
    s.qd[j] = JointSpeed<N>(s.inverse[c], s.u + first, i);
    s.q[j] += h * s.qd[j];
  }
}

// One implicit Euler step of torque-free rotation: solves I (w' - w) + dt w' x I w' = 0 by one
// Newton step, all in B.
HWY_INLINE V3 Gyrate(const V3& w, const V3& I, F dt) {
  const V3 Iw = Times(I, w), residual = Cross(w, Iw) * dt;
  // Columns of I + dt ([w]x I - [Iw]x).
  const V3 x = {I.x, dt * (w.z * I.x - Iw.z), dt * (Iw.y - w.y * I.x)};
  const V3 y = {dt * (Iw.z - w.z * I.y), I.y, dt * (w.x * I.y - Iw.x)};
  const V3 z = {dt * (w.y * I.z - Iw.y), dt * (Iw.x - w.x * I.z), I.z};
  const V3 yz = Cross(y, z);
  const F scale = Reciprocal(Dot(x, yz));
  const V3 change = {Dot(residual, yz), Dot(residual, Cross(z, x)), Dot(residual, Cross(x, y))};
  return w - change * scale;
}

HWY_INLINE ObjectState StartObject(const BlockLayout& at, const float* block, F h, F substep) {
  const auto row = [block](int r) HWY_ATTR { return block + r * kBlockLanes; };
  ObjectState o;
  o.R = RotationOf(
      {Load(row(at.quat)), Load(row(at.quat + 1)), Load(row(at.quat + 2)), Load(row(at.quat + 3))});
  o.x = LoadV3(row(at.x));
  o.v = LoadV3(row(at.v));
  o.w = LoadV3(row(at.w));
  o.com = LoadV3(row(at.com));
  const F free = Load(row(at.free)), root_mass = Load(row(at.root_mass)) * free;
  const V3 root_inertia = LoadV3(row(at.root_inertia));
  o.s_mass = Reciprocal(Load(row(at.root_mass))) * free;
  o.s_inertia =
      V3{Reciprocal(root_inertia.x), Reciprocal(root_inertia.y), Reciprocal(root_inertia.z)} * free;
  o.vs = o.v * root_mass;
  o.ws = Times(Gyrate(Back(o.R, o.w), Times(root_inertia, root_inertia), substep), root_inertia) *
         free;
  o.pull = (LoadV3(row(at.gravity)) * root_mass + LoadV3(row(at.push)) * o.s_mass) * h;
  return o;
}

}  // namespace HWY_NAMESPACE
}  // namespace dexremoe
HWY_AFTER_NAMESPACE();

#endif
