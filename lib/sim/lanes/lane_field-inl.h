// The object's distance field, in lanes of their own objects.
#if defined(DEXREMOE_LANE_FIELD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DEXREMOE_LANE_FIELD_INL_H
#undef DEXREMOE_LANE_FIELD_INL_H
#else
#define DEXREMOE_LANE_FIELD_INL_H
#endif

#include "sim/lanes/lane_math-inl.h"
#include "sim/lanes/lanes_model.h"
#include "sim/lanes/object_field.h"

HWY_BEFORE_NAMESPACE();
namespace dexremoe {
namespace HWY_NAMESPACE {

// The object's distance field, and what bounds the object, per lane.
struct Field {
  F reach;                  // bounding sphere about the origin of B; m
  V3 box_center, box_half;  // in B; m
  I first;                  // byte of its first node
  V3 scale;                 // nodes per m
  V3 shift;                 // nodes
  F unit;                   // m per count
  V3 spacing;               // m
};

HWY_INLINE Field LoadField(const BlockLayout& at, const float* block) {
  const auto row = [block](int r) HWY_ATTR { return block + r * kBlockLanes; };
  Field field;
  field.first =
      hn::ShiftLeft<1>(hn::Load(IntTag(), reinterpret_cast<const std::int32_t*>(row(at.field))));
  field.scale = LoadV3(row(at.field_scale));
  field.shift = LoadV3(row(at.field_shift));
  field.unit = Load(row(at.field_unit));
  field.reach = Load(row(at.reach));
  field.box_center = LoadV3(row(at.box));
  field.box_half = LoadV3(row(at.box + 3));
  field.spacing = {Reciprocal(field.scale.x), Reciprocal(field.scale.y), Reciprocal(field.scale.z)};
  return field;
}

struct Sample {
  F distance;   // m
  V3 gradient;  // unit, or zero where the field is flat
};

struct Pair {
  F low, high;
};

// The nodes at a byte offset and their neighbours along z, in counts.
HWY_INLINE Pair GatherPair(const std::int16_t* nodes, I offset) {
  const I pair = hn::GatherOffset(IntTag(), reinterpret_cast<const std::int32_t*>(nodes), offset);
  return {hn::ConvertTo(FloatTag(), hn::ShiftRight<16>(hn::ShiftLeft<16>(pair))),
          hn::ConvertTo(FloatTag(), hn::ShiftRight<16>(pair))};
}

// Trilinear value and its gradient at p (in B; m). Beyond the grid the value on its border; with
// kFar the way to the border is added.
template <bool kFar>
HWY_INLINE Sample SampleField(const Field& field, const std::int16_t* nodes, const V3& p) {
  const V3 g = Times(p, field.scale) + field.shift;
  const F top(kFieldNodes - 1.001f), zero(0.0f);
  const V3 c = {Clamp(g.x, zero, top), Clamp(g.y, zero, top), Clamp(g.z, zero, top)};
  const I x = hn::ConvertTo(IntTag(), c.x.v), y = hn::ConvertTo(IntTag(), c.y.v),
          z = hn::ConvertTo(IntTag(), c.z.v);
  const V3 t = {c.x - F(hn::ConvertTo(FloatTag(), x)), c.y - F(hn::ConvertTo(FloatTag(), y)),
                c.z - F(hn::ConvertTo(FloatTag(), z))};
  constexpr int kBytes = sizeof(std::int16_t);
  static_assert(FieldIndex(1, 0, 0) * kBytes == 1 << 11 && FieldIndex(0, 1, 0) * kBytes == 1 << 6);
  const I offset = hn::Add(hn::Add(field.first, hn::ShiftLeft<1>(z)),
                           hn::Add(hn::ShiftLeft<11>(x), hn::ShiftLeft<6>(y)));
  const Pair a = GatherPair(nodes, offset), b = GatherPair(nodes + FieldIndex(0, 1, 0), offset),
             d = GatherPair(nodes + FieldIndex(1, 0, 0), offset),
             e = GatherPair(nodes + FieldIndex(1, 1, 0), offset);
  // Along z, then y, then x.
  const F az = a.high - a.low, bz = b.high - b.low, dz = d.high - d.low, ez = e.high - e.low;
  const F va = a.low + t.z * az, vb = b.low + t.z * bz, vd = d.low + t.z * dz,
          ve = e.low + t.z * ez;
  const F z0 = az + t.y * (bz - az), z1 = dz + t.y * (ez - dz);
  const F ab = vb - va, de = ve - vd;
  const F v0 = va + t.y * ab, v1 = vd + t.y * de;
  const V3 slope = {(v1 - v0) * field.scale.x, (ab + t.x * (de - ab)) * field.scale.y,
                    (z0 + t.x * (z1 - z0)) * field.scale.z};
  Sample sample;
  sample.distance = (v0 + t.x * (v1 - v0)) * field.unit;
  if constexpr (kFar) {
    const V3 out = Times(g - c, field.spacing);
    const F out2 = Dot(out, out);
    sample.distance += out2 * RoughInverseSqrt(out2 + F(1e-20f));
  }
  sample.gradient = slope * RoughInverseSqrt(Dot(slope, slope) + F(1e-3f));
  return sample;
}

}  // namespace HWY_NAMESPACE
}  // namespace dexremoe
HWY_AFTER_NAMESPACE();

#endif
