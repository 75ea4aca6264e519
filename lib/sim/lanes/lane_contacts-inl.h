// Where the hand meets the object, and fingers each other, in all lanes.
#if defined(DEXREMOE_LANE_CONTACTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DEXREMOE_LANE_CONTACTS_INL_H
#undef DEXREMOE_LANE_CONTACTS_INL_H
#else
#define DEXREMOE_LANE_CONTACTS_INL_H
#endif

#include "sim/lanes/lane_dynamics-inl.h"
#include "sim/lanes/object_field.h"

HWY_BEFORE_NAMESPACE();
namespace dexremoe {
namespace HWY_NAMESPACE {

// Cores are searched for contacts this far from the object's bounding sphere and box.
constexpr float kLook = 6e-3f;  // m
// What forces may close beyond the present speed within a substep: points that stay farther apart
// than this are left out.
constexpr float kForceReach = 1e-3f;  // m
// Two points of one core nearer than this are one.
constexpr float kSameSpot = 2e-3f;  // m
// From each start the nearest point is sought by alternating projections: so many on plates and
// boxes. On capsules there is one in a substep, going on from the last one's point drawn back
// towards its end by a share, so that the two points of a capsule that lies flat spread again.
constexpr int kRounds = 2;
constexpr float kDrawBack = 0.25f;
// A projection goes this much farther than to the nearest point: a start beyond the rim of a face
// then ends on the face, where the normal is right, and not on the rim.
constexpr float kOvershoot = 1.2f;
constexpr int kStarts = 4;  // of a core, at most

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

// Contact points between the object and one finger or the palm; slot k is filled in lanes with
// more than k points.
struct Contacts {
  V3 point[kSlots];   // midway between the surfaces, W; m
  V3 normal[kSlots];  // from object to hand, W
  F gap[kSlots];      // m
  F link[kSlots];     // index in the chain
  F key[kSlots];      // the same for the same core and start
  F tip[kSlots];      // 1 for a fingertip
  F count;
  int slots;

  HWY_INLINE void Clear(int slots_here) {
    slots = slots_here;
    count = F(0.0f);
    for (int k = 0; k < slots; ++k) {
      // Harmless numbers for lanes that leave the slot empty.
      point[k] = {F(0.0f), F(0.0f), F(0.0f)};
      normal[k] = {F(0.0f), F(0.0f), F(1.0f)};
      gap[k] = tip[k] = F(0.0f);
      link[k] = key[k] = F(-1.0f);
    }
  }

  HWY_INLINE void Put(int k, M where, const V3& p, const V3& n, F g, F of_link, F of_key,
                      F is_tip) {
    StoreWhere(where, p, point[k]);
    StoreWhere(where, n, normal[k]);
    StoreWhere(where, g, gap[k]);
    StoreWhere(where, of_link, link[k]);
    StoreWhere(where, of_key, key[k]);
    StoreWhere(where, is_tip, tip[k]);
  }

  // Adds a point in the lanes `where`; in full lanes it takes the place of the shallowest point if
  // it is deeper.
  HWY_INLINE void Add(M where, const V3& p, const V3& n, F g, F of_link, F of_key, F is_tip) {
    for (int k = 0; k < slots; ++k) {
      const M here = And(where, count == F(static_cast<float>(k)));
      if (Any(here)) Put(k, here, p, n, g, of_link, of_key, is_tip);
    }
    M full = And(where, count == F(static_cast<float>(slots)));
    count = Select(where, Min(count + F(1.0f), F(static_cast<float>(slots))), count);
    if (!Any(full)) return;
    F shallowest = gap[0];
    for (int k = 1; k < slots; ++k) shallowest = Max(shallowest, gap[k]);
    full = And(full, g < shallowest);
    for (int k = 0; k < slots; ++k) {
      const M here = And(full, gap[k] == shallowest);
      Put(k, here, p, n, g, of_link, of_key, is_tip);
      full = AndNot(here, full);
    }
  }
};

// A core in W, and relative to the object.
struct PlacedCore {
  V3 center, axis[3];          // W
  V3 center_B, axis_B[3];      // in B, from its origin
  V3 origin, velocity, omega;  // of its link
};

template <int kExtents>
HWY_INLINE PlacedCore Place(const LaneCore& core, int joint, const HandState& hand,
                            const ObjectState& object) {
  PlacedCore placed;
  const V3 zero = {F(0.0f), F(0.0f), F(0.0f)};
  const V3 center = Everywhere(core.center);
  placed.center = joint < 0 ? center : hand.origin[joint] + hand.R[joint] * center;
  placed.origin = joint < 0 ? zero : hand.origin[joint];
  placed.velocity = joint < 0 ? zero : hand.velocity[joint];
  placed.omega = joint < 0 ? zero : hand.omega[joint];
  placed.center_B = Back(object.R, placed.center - object.x) + object.com;
  for (int e = 0; e < kExtents; ++e) {
    const V3 axis = Everywhere(core.axes + 3 * e);
    placed.axis[e] = joint < 0 ? axis : hand.R[joint] * axis;
    placed.axis_B[e] = Back(object.R, placed.axis[e]);
  }
  return placed;
}

template <int kExtents>
HWY_INLINE V3 PointAt(const V3& center, const V3* axis, const F* s) {
  V3 p = center;
  for (int e = 0; e < kExtents; ++e) p = p + axis[e] * s[e];
  return p;
}

// Whether the core's box along the axes of B overlaps the object's, with room to look around.
template <int kExtents>
HWY_INLINE M NearBox(const PlacedCore& core, const F* half, F radius, const Field& field) {
  const F look = radius + F(kLook);
  V3 size = {look, look, look};
  for (int e = 0; e < kExtents; ++e) size = size + AbsOf(core.axis_B[e]) * half[e];
  const V3 apart = AbsOf(core.center_B - field.box_center) - field.box_half - size;
  return Max(apart.x, Max(apart.y, apart.z)) < F(0.0f);
}

// Up to kStarts points of the core nearest to the object: from starts at the core's ends (corners)
// the point moves to and fro between the object's surface and the core.
template <int kExtents>
HWY_NOINLINE void FindContacts(const LanesModel& model, const LaneCore& core, int id, int joint,
                               const HandState& hand, const ObjectState& object, const Field& field,
                               F dt, float* inset, Contacts& contacts) {
  const PlacedCore placed = Place<kExtents>(core, joint, hand, object);
  const std::int16_t* nodes = model.nodes.data();
  const F radius(core.radius);
  F half[kExtents + 1], middle[kExtents + 1];
  for (int e = 0; e < kExtents; ++e) {
    half[e] = F(core.half[e]);
    middle[e] = Clamp(-Dot(placed.center_B, placed.axis_B[e]), -half[e], half[e]);
  }
  const V3 nearest = PointAt<kExtents>(placed.center_B, placed.axis_B, middle);
  const F around = field.reach + radius, within = around + F(kLook);
  const M near =
      And(Dot(nearest, nearest) < within * within, NearBox<kExtents>(placed, half, radius, field));
  if (!Any(near)) return;
  constexpr int kCount = kExtents == 0 ? 1 : kExtents == 1 ? 2 : kStarts;
  // The starts side by side: each is a long chain of dependent operations.
  F s[kCount][kExtents + 1];
  for (int start = 0; start < kCount; ++start)
    for (int e = 0; e < kExtents; ++e) {
      const bool up = e == 0 ? (start & 1) : (start & 2);
      s[start][e] = e == 2 ? middle[e]
                           : Clamp(up ? middle[e] + around : middle[e] - around, -half[e], half[e]);
    }
  if constexpr (kExtents == 1) {
    s[0][0] = Max(s[0][0], F(1 - kDrawBack) * Load(inset) - half[0]);
    s[1][0] = Min(s[1][0], half[0] - F(1 - kDrawBack) * Load(inset + kBlockLanes));
  }
  V3 found[kCount];
  for (int round = 0; round < (kExtents == 0 ? 0 : kExtents == 1 ? 1 : kRounds); ++round) {
    Sample at[kCount];
    for (int start = 0; start < kCount; ++start)
      at[start] = SampleField<true>(field, nodes,
                                    PointAt<kExtents>(placed.center_B, placed.axis_B, s[start]));
    for (int start = 0; start < kCount; ++start)
      for (int e = 0; e < kExtents; ++e)
        s[start][e] = Clamp(s[start][e] - F(kOvershoot) * at[start].distance *
                                              Dot(at[start].gradient, placed.axis_B[e]),
                            -half[e], half[e]);
  }
  if constexpr (kExtents == 1) {
    StoreWhere(near, s[0][0] + half[0], inset);
    StoreWhere(near, half[0] - s[1][0], inset + kBlockLanes);
  }
  Sample last[kCount];
  for (int start = 0; start < kCount; ++start) {
    found[start] = PointAt<kExtents>(placed.center_B, placed.axis_B, s[start]);
    last[start] = SampleField<false>(field, nodes, found[start]);
  }
  for (int start = 0; start < kCount; ++start) {
    const Sample& at = last[start];
    const F gap = at.distance - radius;
    const V3 normal = object.R * at.gradient;
    const V3 point =
        PointAt<kExtents>(placed.center, placed.axis, s[start]) - normal * (radius + F(0.5f) * gap);
    const V3 apart = placed.velocity + Cross(placed.omega, point - placed.origin) - object.v -
                     Cross(object.w, point - object.x);
    M touches = And(near, gap + dt * Dot(apart, normal) < F(kForceReach));
    for (int other = 0; other < start; ++other) {
      const V3 d = found[start] - found[other];
      touches = AndNot(Dot(d, d) < F(kSameSpot * kSameSpot), touches);
    }
    if (Any(touches))
      contacts.Add(touches, point, normal, gap, F(static_cast<float>(core.link)),
                   F(static_cast<float>(id * kStarts + start)), F(core.tip ? 1.0f : 0.0f));
  }
}

HWY_INLINE void FindAllContacts(const LanesModel& model, const HandState& hand,
                                const ObjectState& object, const Field& field, F dt, float* insets,
                                Contacts* contacts) {
  const int chains = static_cast<int>(model.chains.size());
  for (int c = 0; c < chains; ++c) contacts[c].Clear(kFingerSlots);
  contacts[chains].Clear(kSlots);
  for (int id = 0; id < static_cast<int>(model.cores.size()); ++id) {
    const LaneCore& core = model.cores[id];
    const int joint = core.chain < 0 ? -1 : model.chains[core.chain].first + core.link;
    float* inset = insets + 2 * id * kBlockLanes;
    Contacts& group = contacts[core.chain < 0 ? chains : core.chain];
    switch (core.extents) {
      case 0:
        FindContacts<0>(model, core, id, joint, hand, object, field, dt, inset, group);
        break;
      case 1:
        FindContacts<1>(model, core, id, joint, hand, object, field, dt, inset, group);
        break;
      case 2:
        FindContacts<2>(model, core, id, joint, hand, object, field, dt, inset, group);
        break;
      default:
        FindContacts<3>(model, core, id, joint, hand, object, field, dt, inset, group);
    }
  }
}

// The deepest point between a fingertip and another finger, or the palm.
struct SelfContact {
  int chain_a = 0, chain_b = 0;  // b: -1 for the palm
  V3 point, normal;              // from b to a, W
  F gap, link_a, link_b;

  HWY_INLINE void Deepen(const V3& p, const V3& n, F g, F of_a, F of_b) {
    const M deeper = g < gap;
    point = Select(deeper, p, point);
    normal = Select(deeper, n, normal);
    gap = Select(deeper, g, gap);
    link_a = Select(deeper, of_a, link_a);
    link_b = Select(deeper, of_b, link_b);
  }
};

// A capsule's or sphere's core in W.
struct Segment {
  V3 center, axis;
  F half;
};

HWY_INLINE Segment PlaceSegment(const LanesModel& model, const LaneCore& core,
                                const HandState& hand) {
  const int joint = model.chains[core.chain].first + core.link;
  return {hand.origin[joint] + hand.R[joint] * Everywhere(core.center),
          hand.R[joint] * Everywhere(core.axes), F(core.half[0])};
}

// Closest points of two segments (Ericson, Real-Time Collision Detection, 2005, section 5.1.9).
HWY_INLINE void MeetSegments(const Segment& a, const Segment& b, float radii, SelfContact& contact,
                             F link_a, F link_b) {
  const V3 r = a.center - b.center;
  const F slant = Dot(a.axis, b.axis), ra = Dot(a.axis, r), rb = Dot(b.axis, r);
  const F across = Max(F(1.0f) - slant * slant, F(1e-4f));
  F s = Clamp((slant * rb - ra) * Reciprocal(across), -a.half, a.half);
  const F t = Clamp(slant * s + rb, -b.half, b.half);
  s = Clamp(slant * t - ra, -a.half, a.half);
  const V3 pa = a.center + a.axis * s, pb = b.center + b.axis * t, d = pa - pb;
  const F inverse = InverseSqrt(Dot(d, d) + F(1e-12f));
  const F gap = Dot(d, d) * inverse - F(radii);
  contact.Deepen((pa + pb) * F(0.5f), d * inverse, gap, link_a, link_b);
}

// Both ends of a segment against a rounded box of the base.
HWY_INLINE void MeetPalm(const Segment& a, float radius, const LaneCore& palm, SelfContact& contact,
                         F link_a) {
  for (const float end : {-1.0f, 1.0f}) {
    const V3 p = a.center + a.axis * (a.half * F(end));
    const V3 from = p - Everywhere(palm.center);
    V3 d = from;  // from the box's nearest point to p
    for (int e = 0; e < 3; ++e) {
      const V3 axis = Everywhere(palm.axes + 3 * e);
      d = d - axis * Clamp(Dot(from, axis), F(-palm.half[e]), F(palm.half[e]));
    }
    // Inside the core it leaves along the shortest extent.
    const V3 shortest = Everywhere(palm.axes + 6);
    const F height = Dot(from, shortest);
    const M below = height < F(0.0f), inside = Dot(d, d) < F(1e-10f);
    const F inverse = InverseSqrt(Dot(d, d) + F(1e-12f));
    const V3 normal = Select(inside, Select(below, shortest * F(-1.0f), shortest), d * inverse);
    const F distance = Select(inside, Abs(height) - F(palm.half[2]), Dot(d, d) * inverse);
    const F gap = distance - F(radius + palm.radius);
    contact.Deepen(p - normal * (F(radius) + F(0.5f) * gap), normal, gap, link_a, F(-1.0f));
  }
}

HWY_INLINE bool SameChains(const LanesModel& model, const LaneCorePair& l, const LaneCorePair& r) {
  return model.cores[l.a].chain == model.cores[r.a].chain &&
         model.cores[l.b].chain == model.cores[r.b].chain;
}

// Whether in any lane the ball around a chain's tip meets another chain's, or reaches down to a
// base core that lies across its third axis (chain_b -1).
HWY_INLINE bool MayMeet(const LanesModel& model, const V3* tips, int chain_a, int chain_b,
                        const LaneCore& core_b) {
  const float radius = model.chains[chain_a].tip_radius + 2 * kForceReach;
  if (chain_b < 0) {
    const F height = Dot(tips[chain_a] - Everywhere(core_b.center), Everywhere(core_b.axes + 6));
    return Any(Abs(height) < F(core_b.half[2] + core_b.radius + radius));
  }
  const V3 d = tips[chain_a] - tips[chain_b];
  const float reach = radius + model.chains[chain_b].tip_radius;
  return Any(Dot(d, d) < F(reach * reach));
}

HWY_INLINE void PlaceTips(const LanesModel& model, const HandState& hand, V3* tips) {
  for (std::size_t c = 0; c < model.chains.size(); ++c) {
    const LaneChain& chain = model.chains[c];
    if (chain.size == 0) continue;
    const int last = chain.first + chain.size - 1;
    tips[c] = hand.origin[last] + hand.R[last] * Everywhere(chain.tip_center);
  }
}

// Fills `contacts` with the deepest contact of each pair of chains that may touch within a time
// step; returns how many.
HWY_NOINLINE int FindSelfContacts(const LanesModel& model, const HandState& hand,
                                  SelfContact* contacts) {
  int count = 0;
  V3 tips[kMaxChains];
  PlaceTips(model, hand, tips);
  for (std::size_t k = 0; k < model.pairs.size();) {
    const int chain_a = model.cores[model.pairs[k].a].chain,
              chain_b = model.cores[model.pairs[k].b].chain;
    const std::size_t first = k;
    while (k < model.pairs.size() && SameChains(model, model.pairs[first], model.pairs[k])) ++k;
    if (!MayMeet(model, tips, chain_a, chain_b, model.cores[model.pairs[first].b])) continue;
    SelfContact& contact = contacts[count];
    contact.chain_a = chain_a;
    contact.chain_b = chain_b;
    contact.gap = F(1.0f);
    contact.point = contact.normal = {F(0.0f), F(0.0f), F(0.0f)};
    contact.link_a = contact.link_b = F(-1.0f);
    for (std::size_t i = first; i < k; ++i) {
      const LaneCore &a = model.cores[model.pairs[i].a], &b = model.cores[model.pairs[i].b];
      const Segment segment = PlaceSegment(model, a, hand);
      const F link_a(static_cast<float>(a.link)), link_b(static_cast<float>(b.link));
      if (b.chain < 0)
        MeetPalm(segment, a.radius, b, contact, link_a);
      else
        MeetSegments(segment, PlaceSegment(model, b, hand), a.radius + b.radius, contact, link_a,
                     link_b);
    }
    if (Any(contact.gap < F(2 * kForceReach))) ++count;
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace dexremoe
HWY_AFTER_NAMESPACE();

#endif
