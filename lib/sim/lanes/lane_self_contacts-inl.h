// Where fingers meet each other and the palm, in all lanes.
#if defined(DEXREMOE_LANE_SELF_CONTACTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DEXREMOE_LANE_SELF_CONTACTS_INL_H
#undef DEXREMOE_LANE_SELF_CONTACTS_INL_H
#else
#define DEXREMOE_LANE_SELF_CONTACTS_INL_H
#endif

#include "sim/lanes/lane_contacts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace dexremoe {
namespace HWY_NAMESPACE {

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

// Whether in any lane the ball around the tip of the pairs' first chain meets the other core's
// chain's, or reaches down to a base core, which lies across its third axis. The pairs
// [first, last) are of the same chains.
HWY_INLINE bool MayMeet(const LanesModel& model, const V3* tips, std::size_t first,
                        std::size_t last) {
  const int chain_a = model.cores[model.pairs[first].a].chain,
            chain_b = model.cores[model.pairs[first].b].chain;
  const float radius = model.chains[chain_a].tip_radius + 2 * kForceReach;
  if (chain_b >= 0) {
    const V3 d = tips[chain_a] - tips[chain_b];
    const float reach = radius + model.chains[chain_b].tip_radius;
    return Any(Dot(d, d) < F(reach * reach));
  }
  for (std::size_t i = first; i < last; ++i) {
    const LaneCore& base = model.cores[model.pairs[i].b];
    const F height = Dot(tips[chain_a] - Everywhere(base.center), Everywhere(base.axes + 6));
    if (Any(Abs(height) < F(base.half[2] + base.radius + radius))) return true;
  }
  return false;
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
    if (!MayMeet(model, tips, first, k)) continue;
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
