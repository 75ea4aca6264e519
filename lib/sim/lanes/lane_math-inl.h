// Numbers, vectors and rotations of all lanes at once: one environment per float lane.
//
// Included once per instruction set, inside that set's namespace (see lanes_kernel.cpp). F is a
// float per lane, M a truth value per lane, I an integer per lane. Products followed by sums become
// fused multiply-adds (the kernel is compiled with -ffp-contract=fast).
#if defined(DEXREMOE_LANE_MATH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DEXREMOE_LANE_MATH_INL_H
#undef DEXREMOE_LANE_MATH_INL_H
#else
#define DEXREMOE_LANE_MATH_INL_H
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace dexremoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kBlockLanes>;
using IntTag = hn::Rebind<std::int32_t, FloatTag>;
using M = hn::Mask<FloatTag>;
using I = hn::Vec<IntTag>;

struct F {
  hn::Vec<FloatTag> v;

  F() = default;
  HWY_INLINE F(hn::Vec<FloatTag> value) : v(value) {}
  HWY_INLINE F(float value) : v(hn::Set(FloatTag(), value)) {}
  HWY_INLINE F& operator+=(F b) { return v = hn::Add(v, b.v), *this; }
  HWY_INLINE F& operator-=(F b) { return v = hn::Sub(v, b.v), *this; }
  HWY_INLINE F& operator*=(F b) { return v = hn::Mul(v, b.v), *this; }
};

HWY_INLINE F operator+(F a, F b) { return hn::Add(a.v, b.v); }
HWY_INLINE F operator-(F a, F b) { return hn::Sub(a.v, b.v); }
HWY_INLINE F operator*(F a, F b) { return hn::Mul(a.v, b.v); }
HWY_INLINE F operator-(F a) { return hn::Neg(a.v); }
HWY_INLINE M operator<(F a, F b) { return hn::Lt(a.v, b.v); }
HWY_INLINE M operator>(F a, F b) { return hn::Gt(a.v, b.v); }
HWY_INLINE M operator<=(F a, F b) { return hn::Le(a.v, b.v); }
HWY_INLINE M operator>=(F a, F b) { return hn::Ge(a.v, b.v); }
HWY_INLINE M operator==(F a, F b) { return hn::Eq(a.v, b.v); }
HWY_INLINE M And(M a, M b) { return hn::And(a, b); }
HWY_INLINE M AndNot(M a, M b) { return hn::AndNot(a, b); }  // b and not a
HWY_INLINE bool Any(M m) { return !hn::AllFalse(FloatTag(), m); }

HWY_INLINE F Load(const float* row) { return hn::Load(FloatTag(), row); }
HWY_INLINE void Store(F value, float* row) { hn::Store(value.v, FloatTag(), row); }
// Stores in the lanes `where` only.
HWY_INLINE void StoreWhere(M where, F value, float* row) {
  hn::BlendedStore(value.v, where, FloatTag(), row);
}
HWY_INLINE void StoreWhere(M where, F value, F& to) {
  StoreWhere(where, value, reinterpret_cast<float*>(&to));
}
HWY_INLINE F Min(F a, F b) { return hn::Min(a.v, b.v); }
HWY_INLINE F Max(F a, F b) { return hn::Max(a.v, b.v); }
HWY_INLINE F Clamp(F x, F low, F high) { return Min(Max(x, low), high); }
HWY_INLINE F Abs(F a) { return hn::Abs(a.v); }
HWY_INLINE F Sqrt(F a) { return hn::Sqrt(a.v); }
HWY_INLINE F Select(M m, F yes, F no) { return hn::IfThenElse(m, yes.v, no.v); }
HWY_INLINE F OrZero(M m, F yes) { return hn::IfThenElseZero(m, yes.v); }

// Estimates of at least 12 bits with one Newton step: about 23 bits.
HWY_INLINE F Reciprocal(F a) {
  const F r = hn::ApproximateReciprocal(a.v);
  return r * (F(2.0f) - a * r);
}
HWY_INLINE F InverseSqrt(F a) {
  const F r = hn::ApproximateReciprocalSqrt(a.v);
  return r * (F(1.5f) - F(0.5f) * a * r * r);
}
// Without the Newton step, where a part in 1000 does no harm.
HWY_INLINE F RoughReciprocal(F a) { return hn::ApproximateReciprocal(a.v); }
HWY_INLINE F RoughInverseSqrt(F a) { return hn::ApproximateReciprocalSqrt(a.v); }

struct SineCosine {
  F sine, cosine;
};

// Within 1e-7 for |x| < 100: x = k pi + r, and least-maximum polynomials for |r| < pi / 2.
HWY_INLINE SineCosine SinCos(F x) {
  const F k = hn::Round(hn::Mul(x.v, F(0.318309886f).v));
  const F r = x - k * F(3.14159274f) + k * F(8.7422777e-8f), r2 = r * r;
  const F sine =
      r * (F(0.9999999958f) +
           r2 * (F(-0.16666658f) + r2 * (F(0.008333051245f) +
                                         r2 * (F(-0.0001980908515f) + r2 * F(2.605242734e-6f)))));
  const F cosine =
      F(0.9999999998f) +
      r2 * (F(-0.4999999936f) +
            r2 * (F(0.04166663628f) + r2 * (F(-0.001388836161f) +
                                            r2 * (F(2.476016988e-5f) + r2 * F(-2.605162125e-7f)))));
  const F half = k * F(0.5f), odd = half - F(hn::Floor(half.v));  // 0 or 1/2
  const F sign = F(1.0f) - F(4.0f) * odd;
  return {sine * sign, cosine * sign};
}

struct V3 {
  F x, y, z;
};

HWY_INLINE V3 operator+(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE V3 operator-(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE V3 operator*(const V3& a, F s) { return {a.x * s, a.y * s, a.z * s}; }
HWY_INLINE V3 Times(const V3& a, const V3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
HWY_INLINE V3 AbsOf(const V3& a) { return {Abs(a.x), Abs(a.y), Abs(a.z)}; }
HWY_INLINE F Dot(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE V3 Select(M m, const V3& yes, const V3& no) {
  return {Select(m, yes.x, no.x), Select(m, yes.y, no.y), Select(m, yes.z, no.z)};
}
HWY_INLINE V3 OrZero(M m, const V3& yes) {
  return {OrZero(m, yes.x), OrZero(m, yes.y), OrZero(m, yes.z)};
}
HWY_INLINE void StoreWhere(M where, const V3& value, V3& to) {
  StoreWhere(where, value.x, to.x);
  StoreWhere(where, value.y, to.y);
  StoreWhere(where, value.z, to.z);
}
// The same vector in every lane.
HWY_INLINE V3 Everywhere(const float* a) { return {F(a[0]), F(a[1]), F(a[2])}; }
// The vector of three rows of a block.
HWY_INLINE V3 LoadV3(const float* row) {
  return {Load(row), Load(row + kBlockLanes), Load(row + 2 * kBlockLanes)};
}
HWY_INLINE void StoreV3(const V3& a, float* row) {
  Store(a.x, row);
  Store(a.y, row + kBlockLanes);
  Store(a.z, row + 2 * kBlockLanes);
}

// A rotation by its columns.
struct Rotation {
  V3 x, y, z;
};

HWY_INLINE V3 operator*(const Rotation& R, const V3& a) {
  return R.x * a.x + R.y * a.y + R.z * a.z;
}
// R^T a.
HWY_INLINE V3 Back(const Rotation& R, const V3& a) {
  return {Dot(R.x, a), Dot(R.y, a), Dot(R.z, a)};
}

struct Quaternion {
  F w, x, y, z;
};

HWY_INLINE Rotation RotationOf(const Quaternion& q) {
  const F two(2.0f), one(1.0f);
  Rotation R;
  R.x = {one - two * (q.y * q.y + q.z * q.z), two * (q.x * q.y + q.w * q.z),
         two * (q.x * q.z - q.w * q.y)};
  R.y = {two * (q.x * q.y - q.w * q.z), one - two * (q.x * q.x + q.z * q.z),
         two * (q.y * q.z + q.w * q.x)};
  R.z = {two * (q.x * q.z + q.w * q.y), two * (q.y * q.z - q.w * q.x),
         one - two * (q.x * q.x + q.y * q.y)};
  return R;
}

// The orientation q turned by the world rotation vector a, of unit length again.
HWY_INLINE Quaternion Turned(const Quaternion& q, const V3& a) {
  const V3 half = a * F(0.5f);
  const F angle = Sqrt(Dot(half, half) + F(1e-30f));
  const SineCosine turn = SinCos(angle);
  const F c = turn.cosine;
  const V3 s = half * (turn.sine * Reciprocal(angle));
  Quaternion r = {
      c * q.w - s.x * q.x - s.y * q.y - s.z * q.z, c * q.x + s.x * q.w + s.y * q.z - s.z * q.y,
      c * q.y - s.x * q.z + s.y * q.w + s.z * q.x, c * q.z + s.x * q.y - s.y * q.x + s.z * q.w};
  const F unit = InverseSqrt(r.w * r.w + r.x * r.x + r.y * r.y + r.z * r.z);
  return {r.w * unit, r.x * unit, r.y * unit, r.z * unit};
}

}  // namespace HWY_NAMESPACE
}  // namespace dexremoe
HWY_AFTER_NAMESPACE();

#endif
