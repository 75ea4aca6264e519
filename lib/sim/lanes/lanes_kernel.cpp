#include "sim/lanes/lanes_kernel.h"

// One source for every instruction set: Highway includes this file again for each.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/lanes/lanes_kernel.cpp"
#define HWY_BROKEN_EMU128 0  // g++ 12 passes all tests with it; the alternative has one lane
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <algorithm>

#include "sim/lanes/lane_solver-inl.h"

HWY_BEFORE_NAMESPACE();
namespace dexremoe {
namespace HWY_NAMESPACE {

constexpr int kMaxSelfContacts = kMaxChains * (kMaxChains + 1) / 2;
constexpr int kGroups = kMaxChains + 1;

// Everything of a substep.
struct Substep {
  HandState hand;
  ObjectState object;
  Friction friction;
  Contacts found[kGroups];  // of each chain, then of the palm
  int used[kGroups];        // slots that any lane uses
  ContactRows rows[kGroups][kSlots];
  SelfContact self_found[kMaxSelfContacts];
  SelfRow self[kMaxSelfContacts];
  int self_count = 0;
};

HWY_INLINE std::uint64_t Now() {
#if HWY_ARCH_X86
  return __builtin_ia32_rdtsc();
#else
  return 0;
#endif
}

// Adds the time since the last call to one phase.
class Clock {
 public:
  explicit Clock(KernelCounts* counts) : counts_(counts), last_(counts ? Now() : 0) {}
  HWY_INLINE void Count(LanesPhase phase) {
    if (counts_ == nullptr) return;
    const std::uint64_t now = Now();
    counts_->ticks[phase] += now - last_;
    last_ = now;
  }

 private:
  KernelCounts* counts_;
  std::uint64_t last_;
};

HWY_INLINE float* Row(float* block, int row) { return block + row * kBlockLanes; }

HWY_INLINE void LoadHand(const LanesModel& model, float* block, HandState& hand) {
  const BlockLayout& at = model.layout;
  for (int j = 0; j < at.joints; ++j) {
    hand.q[j] = Load(Row(block, at.q + j));
    hand.qd[j] = Load(Row(block, at.qd + j));
    hand.target[j] =
        Clamp(Load(Row(block, at.target + j)), F(model.links[j].lower), F(model.links[j].upper));
  }
}

HWY_INLINE void StoreHand(const LanesModel& model, const HandState& hand, float* block) {
  const BlockLayout& at = model.layout;
  for (int j = 0; j < at.joints; ++j) {
    Store(hand.q[j], Row(block, at.q + j));
    Store(hand.qd[j], Row(block, at.qd + j));
  }
}

HWY_NOINLINE void Start(const LanesModel& model, float* block, F h, Substep& s) {
  const BlockLayout& at = model.layout;
  s.hand.kp = Load(Row(block, at.kp));
  s.hand.damping = Load(Row(block, at.kd)) + h * s.hand.kp;
  const V3 gravity = LoadV3(Row(block, at.gravity));
  for (int c = 0; c < at.chains; ++c)
    WithSize(model.chains[c].size, [&](auto n) HWY_ATTR {
      StartChain<decltype(n)::value>(model, c, gravity, h, s.hand);
    });
  s.object = StartObject(at, block, h, F(model.substep));
}

HWY_NOINLINE void FindAll(const LanesModel& model, float* block, Substep& s) {
  const BlockLayout& at = model.layout;
  const Field field = LoadField(at, block);
  FindAllContacts(model, s.hand, s.object, field, F(model.substep), Row(block, at.inset), s.found);
  s.self_count = FindSelfContacts(model, s.hand, s.self_found);
}

HWY_NOINLINE void SetUp(const LanesModel& model, float* block, Substep& s) {
  const BlockLayout& at = model.layout;
  for (int g = 0; g <= at.chains; ++g) {
    const bool palm = g == at.chains;
    const int first = palm ? 0 : model.chains[g].first, size = palm ? 0 : model.chains[g].size;
    s.used[g] = 0;
    while (s.used[g] < s.found[g].slots && Any(s.found[g].count > F(static_cast<float>(s.used[g]))))
      ++s.used[g];
    for (int k = 0; k < s.used[g]; ++k) {
      WithSize(size, [&](auto n) HWY_ATTR {
        SetUpContact<decltype(n)::value>(palm ? 0 : g, first, s.found[g], k, s.hand, s.object,
                                         s.friction.soft, s.rows[g][k]);
      });
      Inherit(at, block, g, s.found[g].key[k], s.found[g].count > F(static_cast<float>(k)),
              s.rows[g][k]);
    }
  }
  for (int k = 0; k < s.self_count; ++k) s.self[k] = SetUpSelf(model, s.self_found[k], s.hand);
}

// Calls each(rows, velocity) for the contacts of all chains, then of the palm; `velocity` is the
// Velocity<N> of chain and object.
template <class Each>
HWY_INLINE void ForEachContact(const LanesModel& model, Substep& s, Each&& each) {
  const int chains = static_cast<int>(model.chains.size());
  for (int g = 0; g <= chains; ++g) {
    if (s.used[g] == 0) continue;
    const bool palm = g == chains;
    F* u = s.hand.u + (palm ? 0 : model.chains[g].first);
    WithSize(palm ? 0 : model.chains[g].size, [&](auto n) HWY_ATTR {
      Velocity<decltype(n)::value> velocity(u, s.object);
      for (int k = 0; k < s.used[g]; ++k) each(s.rows[g][k], velocity);
      velocity.Return(u, s.object);
    });
  }
}

// Servo, gravity, push, and the impulses of the step before as a first guess.
HWY_INLINE void Drive(const LanesModel& model, F h, F rate, Substep& s) {
  for (int c = 0; c < static_cast<int>(model.chains.size()); ++c)
    WithSize(model.chains[c].size,
             [&](auto n) HWY_ATTR { DriveChain<decltype(n)::value>(model, c, h, rate, s.hand); });
  s.object.vs = s.object.vs + s.object.pull;
  ForEachContact(model, s, [&](ContactRows& rows, auto& velocity) HWY_ATTR {
    rows.ask = SeparationSpeed(rows.gap, rate);
    for (int r = 0; r < 3; ++r) velocity.Add(rows, r, rows.impulse[r]);
    if (s.friction.soft) velocity.Add(rows.spin, rows.spin.impulse);
  });
  for (int k = 0; k < s.self_count; ++k) {
    s.self[k].ask = SeparationSpeed(s.self[k].gap, rate);
    s.self[k].impulse = F(0.0f);
  }
}

// One round of Gauss-Seidel. `spent` holds the limits' corrections so far (see LimitJoints).
HWY_INLINE void Sweep(const LanesModel& model, F h, F* spent, Substep& s) {
  for (int c = 0; c < static_cast<int>(model.chains.size()); ++c)
    WithSize(model.chains[c].size,
             [&](auto n) HWY_ATTR { LimitJoints<decltype(n)::value>(model, c, h, s.hand, spent); });
  for (int k = 0; k < s.self_count; ++k) SolveSelf(s.self[k], s.hand.u);
  ForEachContact(model, s, [&](ContactRows& rows, auto& velocity) HWY_ATTR {
    SolveContact(rows, s.friction.slide, velocity);
    if (s.friction.soft) SolveSpin(rows, s.friction, velocity);
  });
}

// One time step with the contacts' directions as they were found; gaps follow the normal speed.
HWY_NOINLINE void Advance(const LanesModel& model, float* block, F h, F rate, Substep& s) {
  F spent[kMaxJoints];
  for (int j = 0; j < model.layout.joints; ++j) spent[j] = F(0.0f);
  Drive(model, h, rate, s);
  for (int k = 0; k < model.iterations; ++k) Sweep(model, h, spent, s);
  for (int c = 0; c < model.layout.chains; ++c)
    WithSize(model.chains[c].size,
             [&](auto n) HWY_ATTR { FinishChain<decltype(n)::value>(model, c, h, s.hand); });
  ForEachContact(model, s, [&](ContactRows& rows, auto& velocity) HWY_ATTR {
    rows.gap += h * velocity.Along(rows, 0);
  });
  for (int k = 0; k < s.self_count; ++k) s.self[k].gap += h * SelfSpeed(s.self[k], s.hand.u);
  const BlockLayout& at = model.layout;
  // A held object's zeros are made positive: their signs depend on other lanes' contacts.
  const V3 zero = {F(0.0f), F(0.0f), F(0.0f)};
  const V3 v = s.object.vs * s.object.s_mass + zero;
  const V3 w = s.object.R * Times(s.object.ws, s.object.s_inertia) + zero;
  StoreV3(LoadV3(Row(block, at.x)) + v * h, Row(block, at.x));
  const Quaternion turned = Turned({Load(Row(block, at.quat)), Load(Row(block, at.quat + 1)),
                                    Load(Row(block, at.quat + 2)), Load(Row(block, at.quat + 3))},
                                   w * h);
  Store(turned.w, Row(block, at.quat));
  StoreV3({turned.x, turned.y, turned.z}, Row(block, at.quat + 1));
  StoreV3(v, Row(block, at.v));
  StoreV3(w, Row(block, at.w));
}

// Keeps the impulses for the next substep and reports who touches.
HWY_NOINLINE void Finish(const LanesModel& model, float* block, F rate, Substep& s) {
  const BlockLayout& at = model.layout;
  F points(0.0f), depth(0.0f);
  for (int g = 0; g <= at.chains; ++g) {
    F touch(0.0f);
    for (int k = 0; k < kSlots; ++k) {
      float* row = Row(block, at.Contact(g, k));
      F normal(0.0f), spin(0.0f);
      V3 friction = {F(0.0f), F(0.0f), F(0.0f)};
      if (k < s.used[g]) {
        const ContactRows& rows = s.rows[g][k];
        const M here = s.found[g].count > F(static_cast<float>(k));
        normal = OrZero(here, rows.impulse[0]);
        friction =
            OrZero(here, rows.tangent[0] * rows.impulse[1] + rows.tangent[1] * rows.impulse[2]);
        if (s.friction.soft) spin = OrZero(here, rows.spin.impulse);
        const M pressed = normal * rate > F(kNoForce);
        points += OrZero(pressed, F(1.0f));
        touch = Max(touch, OrZero(pressed, s.found[g].tip[k]));
        depth = Max(depth, OrZero(here, -s.found[g].gap[k]));
      }
      Store(k < s.found[g].slots ? s.found[g].key[k] : F(-1.0f), row);
      Store(normal, row + kBlockLanes);
      StoreV3(friction, row + 2 * kBlockLanes);
      Store(spin, row + 5 * kBlockLanes);
    }
    if (g < at.chains) Store(touch, Row(block, at.touch + g));
  }
  Store(points, Row(block, at.points));
  Store(depth, Row(block, at.depth));
}

HWY_INLINE void CountSlots(const LanesModel& model, const Substep& s, KernelCounts* counts) {
  if (counts == nullptr) return;
  ++counts->substeps;
  for (int g = 0; g <= model.layout.chains; ++g) {
    counts->slots += s.used[g];
    counts->lanes += s.used[g] * hn::Lanes(FloatTag());
    for (int k = 0; k < s.used[g]; ++k)
      counts->points += hn::CountTrue(FloatTag(), s.found[g].count > F(static_cast<float>(k)));
  }
}

HWY_INLINE void StepLanes(const LanesModel& model, float* block, KernelCounts* counts) {
  const BlockLayout& at = model.layout;
  const float step = model.substep / static_cast<float>(model.inner_steps);
  const F h(step), rate(1 / step);
  Substep s;
  s.friction = LoadFriction(at, block);
  LoadHand(model, block, s.hand);
  Clock clock(counts);
  for (int i = 0; i < model.substeps; ++i) {
    Start(model, block, h, s);
    clock.Count(kDynamicsPhase);
    FindAll(model, block, s);
    clock.Count(kFieldPhase);
    SetUp(model, block, s);
    CountSlots(model, s, counts);
    clock.Count(kSetUpPhase);
    for (int k = 0; k < model.inner_steps; ++k) Advance(model, block, h, rate, s);
    clock.Count(kSolvePhase);
    Finish(model, block, rate, s);
    clock.Count(kFinishPhase);
  }
  StoreHand(model, s.hand, block);
  StoreV3({F(0.0f), F(0.0f), F(0.0f)}, Row(block, at.push));
}

// Narrow instruction sets pass over the block several times.
void StepBlock(const LanesModel& model, float* block, KernelCounts* counts) {
  const int lanes = static_cast<int>(hn::Lanes(FloatTag()));
  for (int lane = 0; lane < kBlockLanes; lane += lanes) StepLanes(model, block + lane, counts);
}

}  // namespace HWY_NAMESPACE
}  // namespace dexremoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dexremoe {

std::vector<LanesKernel> LanesKernels() {
  const std::int64_t supported = hwy::SupportedTargets();
  std::vector<LanesKernel> kernels;
#if HWY_TARGETS & HWY_AVX3
  if (supported & HWY_AVX3) kernels.push_back({"avx512", N_AVX3::StepBlock});
#endif
#if HWY_TARGETS & HWY_AVX2
  if (supported & HWY_AVX2) kernels.push_back({"avx2", N_AVX2::StepBlock});
#endif
#if HWY_TARGETS & HWY_SSE4
  if (supported & HWY_SSE4) kernels.push_back({"sse4", N_SSE4::StepBlock});
#endif
  kernels.push_back({"portable", HWY_STATIC_DISPATCH(StepBlock)});
  return kernels;
}

}  // namespace dexremoe
#endif
