// Soft fingers, in all lanes: the moment about a contact's normal that a patch of rubber carries.
#if defined(DEXREMOE_LANE_SPIN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DEXREMOE_LANE_SPIN_INL_H
#undef DEXREMOE_LANE_SPIN_INL_H
#else
#define DEXREMOE_LANE_SPIN_INL_H
#endif

#include "sim/lanes/lane_contacts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace dexremoe {
namespace HWY_NAMESPACE {

// As kSoftness and kImmovable, for rows of moments. (The object's own share is above 1000 /
// (kg m^2).)
constexpr float kSpinSoftness = 1.0f;    // 1 / (kg m^2)
constexpr float kUnturnable = 1e-3f;     // 1 / (kg m^2)
constexpr float kLeastFriction = 1e-5f;  // 1

// Of an environment's contacts.
struct Friction {
  F slide, inverse;  // Coulomb coefficient, and 1 over it
  F torsion;         // m
  bool soft;         // some lane has torsional friction
};

HWY_INLINE Friction LoadFriction(const BlockLayout& at, const float* block) {
  Friction friction;
  friction.slide = Load(block + at.friction * kBlockLanes);
  friction.inverse = Reciprocal(Max(friction.slide, F(kLeastFriction)));
  friction.torsion = Load(block + at.torsion * kBlockLanes);
  friction.soft = Any(friction.torsion > F(0.0f));
  return friction;
}

// The fourth row of a contact: the hand's angular velocity along the normal less the object's,
// hand . u + object . ws.
struct SpinRow {
  F hand[kMaxChainJoints];
  V3 object;
  F inverse;  // of the row's inverse inertia; 0 in lanes without this point
  F impulse;  // N m s
};

template <int N>
HWY_INLINE void SetUpSpin(int group, int first, const Contacts& found, int k, const HandState& hand,
                          const ObjectState& object, SpinRow& row) {
  const V3& normal = found.normal[k];
  F j[N + 1];
  for (int i = 0; i < N; ++i)
    j[i] = OrZero(found.link[k] >= F(static_cast<float>(i)), Dot(hand.R[first + i].z, normal));
  WhitenedRow<N>(hand.inverse[group], j, row.hand);
  row.object = Times(Back(object.R, normal), object.s_inertia) * F(-1.0f);
  F give = Dot(row.object, row.object);
  for (int i = 0; i < N; ++i) give += row.hand[i] * row.hand[i];
  const M turns = And(found.count > F(static_cast<float>(k)), give > F(kUnturnable));
  row.inverse = OrZero(turns, Reciprocal(give + F(kSpinSoftness)));
}

}  // namespace HWY_NAMESPACE
}  // namespace dexremoe
HWY_AFTER_NAMESPACE();

#endif
