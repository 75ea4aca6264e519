// Domain randomisation: each parameter's statistics, what it does to an episode, and that a
// randomised episode is as reproducible as any.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "task/episode_random.h"
#include "task_fixture.h"

namespace dexremoe {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using internal::EpisodeKey;
using internal::EpisodeRandom;

constexpr int kEpisodes = 20000;

struct Moments {
  double mean = 0, deviation = 0, least = 0, most = 0;
};
Moments MomentsOf(const std::vector<double>& x) {
  Moments m;
  const double n = static_cast<double>(x.size());
  m.mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
  for (const double v : x) m.deviation += (v - m.mean) * (v - m.mean) / n;
  m.deviation = std::sqrt(m.deviation);
  m.least = *std::min_element(x.begin(), x.end());
  m.most = *std::max_element(x.begin(), x.end());
  return m;
}

// One number of each of many episodes.
template <typename Number>
Moments Over(const Number& number) {
  std::vector<double> x;
  for (std::uint64_t e = 0; e < kEpisodes; ++e) x.push_back(number(EpisodeKey{7, e}));
  return MomentsOf(x);
}

EpisodeRandom Episode(const EpisodeKey& key, const RandomOptions& options = {}) {
  return MakeEpisodeRandom(internal::DrawRandomValues(options, 1, key), 1, key, 2);
}

TEST(Randomization, EveryParameterIsSpreadOverItsRangeAsItsTableSays) {
  for (int i = 0; i < kNumRandom; ++i) {
    const RandomParameter& p = kRandomParameters[i];
    SCOPED_TRACE(p.name);
    const bool log = p.spread == Distribution::kLogUniform;
    const double low = log ? std::log(p.low) : p.low, high = log ? std::log(p.high) : p.high;
    const Moments m = Over([&](const EpisodeKey& key) {
      const double x = internal::DrawRandomValues({}, 1, key)[i];
      return log ? std::log(x) : x;
    });
    const double width = high - low, margin = 1e-12 + 4 * width / std::sqrt(12.0 * kEpisodes);
    EXPECT_NEAR(m.mean, (low + high) / 2, margin);
    EXPECT_NEAR(m.deviation, width / std::sqrt(12.0), 0.01 * width + 1e-12);
    EXPECT_GE(m.least, low - 1e-12);
    EXPECT_LE(m.most, high + 1e-12);
    EXPECT_LE(m.least, low + 0.01 * width + 1e-12);
    EXPECT_GE(m.most, high - 0.01 * width - 1e-12);
  }
}

TEST(Randomization, ParametersAreDrawnIndependently) {
  std::vector<std::vector<double>> x(kNumRandom);
  for (std::uint64_t e = 0; e < kEpisodes; ++e) {
    const auto values = internal::DrawRandomValues({}, 1, {7, e});
    for (int i = 0; i < kNumRandom; ++i) x[i].push_back(values[i]);
  }
  for (int i = 0; i < kNumRandom; ++i)
    for (int j = 0; j < i; ++j) {
      const Moments a = MomentsOf(x[i]), b = MomentsOf(x[j]);
      if (a.deviation < 1e-9 || b.deviation < 1e-9) continue;
      double product = 0;
      for (int e = 0; e < kEpisodes; ++e)
        product += (x[i][e] - a.mean) * (x[j][e] - b.mean) / kEpisodes;
      EXPECT_NEAR(product / (a.deviation * b.deviation), 0, 0.03) << i << " " << j;
    }
}

TEST(Randomization, DeviationsOfAnEpisodeAreNormalWithTheirParameter) {
  const auto check = [](const char* what, double deviation, auto number) {
    const Moments m = Over([&](const EpisodeKey& key) { return number(Episode(key)); });
    EXPECT_NEAR(m.mean, 0, 4 * deviation / std::sqrt(kEpisodes)) << what;
    EXPECT_NEAR(m.deviation, deviation, 0.02 * deviation) << what;
    EXPECT_GT(m.most, 3 * deviation) << what;  // no uniform draw
  };
  for (int k = 0; k < 3; ++k) {
    check("gravity", 0.4, [&](const EpisodeRandom& r) { return r.gravity[k]; });
    check("position_bias", 0.005, [&](const EpisodeRandom& r) { return r.position_bias[k]; });
    check("rotation_bias", 0.1, [&](const EpisodeRandom& r) { return r.rotation_bias[k]; });
  }
  check("lower limit", 0.15, [](const EpisodeRandom& r) { return r.lower[1]; });
  check("upper limit", 0.15, [](const EpisodeRandom& r) { return r.upper[0]; });
}

TEST(Randomization, HalfTheEpisodesAreDelayed) {
  const Moments m = Over([](const EpisodeKey& key) { return Episode(key).delayed ? 1.0 : 0.0; });
  EXPECT_NEAR(m.mean, 0.5, 4 * 0.5 / std::sqrt(kEpisodes));
}

TEST(Randomization, WhatIsSeenDeviatesByItsParameters) {
  EpisodeRandom random = Episode({7, 1});
  random.position_bias = {0.003, 0, 0};
  random.rotation_bias = {0, 0, 0.2};
  Rng rng(3, Stream::kTest, {});
  const Pose X_WO = {Quaterniond(Eigen::AngleAxisd(1, Vector3d::UnitY())), {0.1, 0.2, 0.3}};
  std::vector<double> x, turn, joint;
  for (int i = 0; i < kEpisodes; ++i) {
    const Pose seen = internal::SeenPose(random, X_WO, rng);
    x.push_back(seen.p.x() - X_WO.p.x());
    turn.push_back(RotationVector(seen.q * X_WO.q.conjugate()).z());
    std::vector<double> q = {0.5};
    internal::SeeJoints(random, rng, q);
    joint.push_back(q[0] - 0.5);
  }
  EXPECT_NEAR(MomentsOf(x).mean, 0.003, 4e-3 / std::sqrt(kEpisodes));
  EXPECT_NEAR(MomentsOf(x).deviation, 0.001, 2e-5);
  EXPECT_NEAR(MomentsOf(turn).mean, 0.2, 0.4 / std::sqrt(kEpisodes));
  EXPECT_NEAR(MomentsOf(turn).deviation, 0.1, 2e-3);
  EXPECT_NEAR(MomentsOf(joint).mean, 0, 0.08 / std::sqrt(kEpisodes));
  EXPECT_NEAR(MomentsOf(joint).deviation, 0.02, 4e-4);
}

TEST(Randomization, ActionsGetNoiseThatAddsAndNoiseThatScales) {
  const EpisodeRandom random = Episode({7, 1});
  for (const double action : {0.0, 0.6}) {
    Rng rng(4, Stream::kTest, {});
    std::vector<double> x;
    for (int i = 0; i < kEpisodes; ++i) {
      std::vector<double> a = {action};
      internal::DisturbAction(random, rng, a);
      x.push_back(a[0] - action);
    }
    const double deviation = std::hypot(0.05, 0.015 * action);
    EXPECT_NEAR(MomentsOf(x).mean, 0, 4 * deviation / std::sqrt(kEpisodes));
    EXPECT_NEAR(MomentsOf(x).deviation, deviation, 0.02 * deviation);
  }
}

TEST(Randomization, ForceIsDrawnAnewAtItsRateAndDecaysBetween) {
  EpisodeRandom random = Episode({7, 1});
  random.value[kForceRate] = 0.1;
  Rng rng(5, Stream::kTest, {});
  const double mass = 0.08, seconds = 1.0 / 60, decay = std::pow(0.99, seconds / 0.08);
  const Vector3d before(0.5, -0.25, 1);  // far beyond what is drawn
  std::vector<double> fresh;
  for (int i = 0; i < 10 * kEpisodes; ++i) {
    const Vector3d force = internal::NextForce(random, mass, seconds, before, rng);
    if (force.isApprox(decay * before, 1e-12)) continue;
    fresh.push_back(force.x());
  }
  const double expected = 10 * kEpisodes * 0.1 * seconds / 0.08;
  EXPECT_NEAR(static_cast<double>(fresh.size()), expected, 4 * std::sqrt(expected));
  EXPECT_NEAR(MomentsOf(fresh).deviation, mass * 1, 0.05 * mass);
  EXPECT_NEAR(MomentsOf(fresh).mean, 0, 4 * mass / std::sqrt(expected));
}

TEST(Randomization, BoundariesAreTriedAtTheirShareAndEvenly) {
  RandomOptions options;
  options.boundary_share = 0.4;
  std::map<int, int> count;
  for (std::uint64_t e = 0; e < kEpisodes; ++e) {
    const EpisodeKey key{7, e};
    const int bound = internal::DrawBound(options, 1, key);
    ++count[bound];
    if (bound < 0) continue;
    EXPECT_TRUE(BoundMoves(bound));
    EXPECT_EQ(internal::DrawRandomValues(options, 1, key)[bound / 2],
              options.range[bound / 2][bound % 2]);
  }
  EXPECT_NEAR(count[-1] / static_cast<double>(kEpisodes), 0.6, 0.015);
  int moving = 0;
  for (int bound = 0; bound < 2 * kNumRandom; ++bound) moving += BoundMoves(bound);
  EXPECT_EQ(static_cast<int>(count.size()), moving + 1);
  const double each = 0.4 * kEpisodes / moving;
  for (const auto& [bound, times] : count)
    EXPECT_NEAR(times, bound < 0 ? 0.6 * kEpisodes : each, 5 * std::sqrt(0.6 * kEpisodes)) << bound;
}

TaskOptions Randomized() {
  TaskOptions options;
  options.random.on = true;
  return options;
}

// Physics of an environment that is reset to many episodes.
TEST(Randomization, EpisodesOfATaskVaryAsTheParametersSay) {
  FakeTask plain({}, 1), random(Randomized(), 1);
  std::map<std::string, std::vector<double>> ratio;
  for (std::uint64_t e = 0; e < 2000; ++e) {
    plain.batch->Reset(0, 0, e);
    random.batch->Reset(0, 0, e);
    const EnvPhysics &a = plain.sim->physics[0], &b = random.sim->physics[0];
    ratio["size"].push_back(b.scale / a.scale);
    ratio["mass"].push_back(b.mass / a.mass);
    ratio["friction"].push_back(b.friction / a.friction);
    ratio["damping"].push_back(b.kd_factor);
    ratio["stiffness"].push_back(b.kp_factor);
    ratio["gravity"].push_back(b.gravity.z() - a.gravity.z());
    EXPECT_EQ(a.kp_factor, 1);
    EXPECT_EQ(a.gravity.x(), 0);
  }
  for (const auto& [name, x] : ratio) {
    const auto p = std::find_if(kRandomParameters.begin(), kRandomParameters.end(),
                                [&](const RandomParameter& q) { return name == q.name; });
    if (name == "gravity") {
      EXPECT_NEAR(MomentsOf(x).deviation, 0.4, 0.03);
      continue;
    }
    EXPECT_NEAR(MomentsOf(x).least, p->low, 0.02 * p->low) << name;
    EXPECT_NEAR(MomentsOf(x).most, p->high, 0.02 * p->high) << name;
  }
}

TEST(Randomization, RandomisedEpisodeIsTheSameInAnyEnvironment) {
  TaskOptions options = Randomized();
  options.action_repeat = 2;
  FakeTask a(options, 2), b(options, 3);
  a.batch->Reset(1, 0, 42);
  b.batch->Reset(2, 0, 42);
  for (int t = 0; t < 5; ++t) {
    a.Step(0.2f, -0.1f);
    b.Step(0.2f, -0.1f);
  }
  const int obs = a.batch->obs_size(), phys = a.batch->phys_size();
  EXPECT_TRUE(std::equal(a.batch->obs().begin() + obs, a.batch->obs().begin() + 2 * obs,
                         b.batch->obs().begin() + 2 * obs));
  EXPECT_TRUE(std::equal(a.batch->phys().begin() + phys, a.batch->phys().begin() + 2 * phys,
                         b.batch->phys().begin() + 2 * phys));
}

TEST(Randomization, RestoredBatchContinuesBitForBit) {
  TaskOptions options = Randomized();
  options.random.range[kForceRate] = {0.3, 0.3};
  FakeTask whole(options, 4), other(options, 4);
  for (int t = 0; t < 3; ++t) whole.Step(0.3f, 0.1f);
  for (int t = 0; t < 7; ++t) other.Step(-0.3f, 0.2f);
  other.batch->Restore(whole.batch->Save());
  whole.sim->pushes.clear();
  other.sim->pushes.clear();
  for (int t = 0; t < 30; ++t) {
    whole.Step(0.1f, -0.4f);
    other.Step(0.1f, -0.4f);
  }
  EXPECT_EQ(whole.batch->obs(), other.batch->obs());
  EXPECT_EQ(whole.batch->phys(), other.batch->phys());
  EXPECT_EQ(whole.batch->targets(), other.batch->targets());
  EXPECT_EQ(whole.batch->physics(2).gravity, other.batch->physics(2).gravity);
  EXPECT_EQ(whole.batch->physics(2).kd_factor, other.batch->physics(2).kd_factor);
  ASSERT_FALSE(whole.sim->pushes.empty());
  EXPECT_EQ(whole.sim->pushes.size(), other.sim->pushes.size());
}

TEST(Randomization, RewardAndSuccessAreJudgedOnTheTrueState) {
  FakeTask plain({}, 1), random(Randomized(), 1);
  plain.batch->Reset(0, 0, 3);
  random.batch->Reset(0, 0, 3);
  plain.Step();
  random.Step();
  EXPECT_EQ(plain.batch->angle(), random.batch->angle());
  EXPECT_EQ(plain.batch->distance(), random.batch->distance());
  EXPECT_NE(plain.batch->phys()[6], random.batch->phys()[6]);  // seen position
}

// No noise, but every episode delayed: the first of two control steps repeats the last decision.
TEST(Randomization, DelayedActionsBeginOneControlStepLate) {
  TaskOptions options = Randomized();
  for (int i = kGravity; i < kNumRandom; ++i) options.random.range[i] = {0, 0};
  options.random.range[kForceRate] = {1e-6, 1e-6};
  options.random.range[kActionDelay] = {1, 1};
  options.action_repeat = 2;
  FakeTask task(options, 1);
  task.Step(0.5f, 0);
  const double start = task.batch->targets()[0];
  task.Step(-0.5f, 0);
  EXPECT_NEAR(task.batch->targets()[0], start, 1e-12);  // +0.5, then -0.5
  task.Step(-0.5f, 0);
  EXPECT_NEAR(task.batch->targets()[0], start - 2 * 0.5 * options.action_scale, 1e-12);
}

TEST(Randomization, SensorsDoNotShowTheObjectsProperties) {
  TaskOptions options;
  options.extra_inputs = {"goal_vector", "tip_contact", "wait_clock"};
  const HandModel hand = TwoJointHand();
  const std::vector<int> columns = ObservableColumns(options, hand);
  // Beside position, orientation and goal: the goal vector 23..25 and the clock behind the touch.
  EXPECT_EQ(columns,
            (std::vector<int>{6, 7, 8, 9, 10, 11, 12, 19, 20, 21, 22, 23, 24, 25, 28, 29}));
  EXPECT_EQ(columns.back(), PhysSize(options, hand) - 1);
}

TEST(Randomization, MalformedRangesAreErrors) {
  for (const std::vector<double>& range : {std::vector<double>{2, 1}, {1}, {0, 1}}) {
    TaskOptions options;
    options.random.range[kMass] = range;
    EXPECT_THROW(options.Check(), UsageError);
  }
}

TEST(Randomization, ObjectsInUseAreTheFirstOnesAndSpreadWhenTheirNumberGrows) {
  TaskOptions options;
  options.objects_in_use = 1;
  options.episode_length = 1;
  FakeTask task(options, 4);
  task.batch->ResetAll();
  EXPECT_EQ(task.batch->object(), (std::vector<int>{0, 0, 0, 0}));
  task.batch->mutable_options().objects_in_use = 2;
  EXPECT_EQ(task.batch->object(), (std::vector<int>{0, 0, 0, 0}));  // until the episodes end
  task.Step();
  EXPECT_EQ(task.batch->object(), (std::vector<int>{0, 1, 0, 1}));
}

}  // namespace
}  // namespace dexremoe
