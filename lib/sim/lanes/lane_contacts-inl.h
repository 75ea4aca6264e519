// Where the hand meets the object, in all lanes.
#if defined(DEXREMOE_LANE_CONTACTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DEXREMOE_LANE_CONTACTS_INL_H
#undef DEXREMOE_LANE_CONTACTS_INL_H
#else
#define DEXREMOE_LANE_CONTACTS_INL_H
#endif

#include "sim/lanes/lane_dynamics-inl.h"
#include "sim/lanes/lane_field-inl.h"

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

}  // namespace HWY_NAMESPACE
}  // namespace dexremoe
HWY_AFTER_NAMESPACE();

#endif
