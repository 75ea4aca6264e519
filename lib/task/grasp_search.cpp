#include "task/grasp_search.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "base/random.h"
#include "task/episode.h"
#include "task/grasp_hold.h"

namespace dexremoe {
namespace {

using internal::FoundGrasp;

constexpr int kRound = 128;     // candidates at a time; part of the result
constexpr double kReach = 0.3;  // rad that a closing target may lead its joint

// Candidates that are simulated together.
class Round {
 public:
  Round(const GraspOptions& options, const TaskOptions& task, const SimOptions& sim_options,
        const HandModel& hand, BatchSim& sim)
      : options_(options),
        task_(task),
        sim_options_(sim_options),
        hand_(hand),
        sim_(sim),
        rule_(options, task, hand, sim_options.control_rate),
        joints_(hand.num_joints()) {
    targets_.resize(static_cast<std::size_t>(kRound) * joints_);
    squeeze_.resize(kRound);
    physics_.resize(kRound);
  }

  // Tries candidates first .. first + kRound - 1 and appends what holds.
  void Run(std::uint64_t seed, std::uint64_t object_key, int first, GraspCounts& counts,
           std::vector<FoundGrasp>& found) {
    active_.assign(kRound, 1);
    for (int env = 0; env < kRound; ++env) {
      Rng rng(seed, Stream::kGrasp, {object_key, static_cast<std::uint64_t>(first + env)});
      Place(env, rng);
    }
    counts.tried += kRound;
    sim_.Step(targets_, active_);
    Drop(counts.blocked, [&](int env) { return sim_.state().contact_count[env] > 0; });
    for (int step = 0; step < options_.close_steps; ++step) {
      for (int env = 0; env < kRound; ++env) Close(env);
      sim_.Step(targets_, active_);
    }
    Drop(counts.no_grip, [&](int env) { return !rule_.Gripped(sim_.state(), env); });
    for (int env = 0; env < kRound; ++env) sim_.SetHeld(env, false);
    for (int step = 0; step < options_.hold_steps; ++step) {
      before_ = sim_.state();
      sim_.Step(targets_, active_);
      Drop(counts.dropped, [&](int env) { return !rule_.Near(sim_.state(), env); });
    }
    Drop(counts.moving, [&](int env) {
      return !rule_.AtRest(before_, sim_.state(), env) || !rule_.Gripped(sim_.state(), env);
    });
    for (int env = 0; env < kRound; ++env)
      if (active_[env]) found.push_back({GraspOf(env), physics_[env]}), ++counts.accepted;
  }

 private:
  template <typename Test>
  void Drop(int& count, Test&& test) {
    for (int env = 0; env < kRound; ++env)
      if (active_[env] && test(env)) active_[env] = 0, ++count;
  }

  void Place(int env, Rng& rng) {
    EnvState start;
    start.qd.assign(joints_, 0.0);
    for (int j = 0; j < joints_; ++j) {
      const double noise = options_.open_noise[j];
      start.q.push_back(std::clamp(options_.open_pose[j] + rng.Uniform(-noise, noise),
                                   hand_.joints[j].lower, hand_.joints[j].upper));
      targets_[static_cast<std::size_t>(env) * joints_ + j] = start.q[j];
    }
    for (int k = 0; k < 3; ++k) {
      const double noise = options_.position_noise[k];
      start.X_WO.p[k] = task_.grasp_center[k] + rng.Uniform(-noise, noise);
    }
    const std::array<double, 4> u = rng.UnitQuaternion();
    start.X_WO.q = Eigen::Quaterniond(u[0], u[1], u[2], u[3]);
    squeeze_[env] = rng.Uniform(options_.squeeze[0], options_.squeeze[1]);
    EnvPhysics& physics = physics_[env];
    physics.mass = rng.Uniform(task_.mass_range[0], task_.mass_range[1]);
    physics.friction = rng.Uniform(task_.friction_range[0], task_.friction_range[1]);
    physics.scale = task_.scale * rng.Uniform(task_.scale_range[0], task_.scale_range[1]);
    physics.torsional_friction = rng.Uniform(task_.torsion_range[0], task_.torsion_range[1]);
    physics.gravity = {0, 0, sim_options_.gravity};
    sim_.SetObject(env, 0, physics);
    sim_.SetState(env, start);
    sim_.SetHeld(env, true);
  }

  // Moves the targets of the closing joints of one environment on by a control step.
  void Close(int env) {
    const double rate = options_.close_rate / sim_options_.control_rate;
    const SimState& state = sim_.state();
    const std::size_t row = static_cast<std::size_t>(env) * joints_;
    for (std::size_t f = 0; f < hand_.chains.size(); ++f) {
      const std::vector<int>& chain = hand_.chains[f];
      const double reach = rule_.Touches(state, env, f) ? squeeze_[env] : kReach;
      for (std::size_t k = chain.size() < 2 ? 0 : chain.size() - 2; k < chain.size(); ++k) {
        const int j = chain[k];
        double& target = targets_[row + j];
        target =
            std::min({target + rate, state.joint_position[row + j] + reach, hand_.joints[j].upper});
      }
    }
  }

  Grasp GraspOf(int env) const {
    const std::size_t row = static_cast<std::size_t>(env) * joints_;
    const EnvState state = sim_.GetState(env);
    Grasp grasp;
    grasp.q = state.q;
    grasp.target.assign(targets_.begin() + row, targets_.begin() + row + joints_);
    grasp.X_WO = {state.X_WO.q.normalized(), state.X_WO.p};
    grasp.scale = physics_[env].scale;
    return grasp;
  }

  const GraspOptions& options_;
  const TaskOptions& task_;
  const SimOptions& sim_options_;
  const HandModel& hand_;
  BatchSim& sim_;
  internal::HoldRule rule_;
  int joints_;
  std::vector<double> targets_;  // [kRound, J], rad
  std::vector<double> squeeze_;
  std::vector<EnvPhysics> physics_;
  std::vector<std::uint8_t> active_;
  SimState before_;  // one control step back
};

// Leaves what holds on the certifying engine too.
void DropRefused(internal::Certifier& certifier, GraspCounts& counts,
                 std::vector<FoundGrasp>& found) {
  const std::vector<std::uint8_t> holds = certifier.Certify(found);
  std::vector<FoundGrasp> kept;
  for (std::size_t g = 0; g < found.size(); ++g)
    if (holds[g]) kept.push_back(std::move(found[g]));
  counts.certified += static_cast<int>(kept.size());
  counts.refused += static_cast<int>(found.size() - kept.size());
  found = std::move(kept);
}

}  // namespace

void GraspOptions::Register(Options& options) {
  options.Add("grasp.count", &count, "grasps per object").Range(1, 1e6);
  options.Add("grasp.candidates", &candidates, "give up after so many").Range(1, 1e9);
  options.Add("grasp.open_pose", &open_pose, "open hand, rad, by joint");
  options.Add("grasp.open_noise", &open_noise, "half widths of the noise on it, rad, by joint");
  options.Add("grasp.position_noise", &position_noise, "about task.grasp_center, m: x,y,z");
  options.Add("grasp.close_rate", &close_rate, "rad/s of the closing targets").Range(1e-3, 100);
  options.Add("grasp.close_steps", &close_steps, "control steps").Range(1, 10000);
  options.Add("grasp.squeeze", &squeeze, "rad that targets lead the joints at contact: low,high");
  options.Add("grasp.hold_steps", &hold_steps, "control steps to hold under gravity")
      .Range(1, 100000);
  options.Add("grasp.max_distance", &max_distance, "m from task.grasp_center after it")
      .Range(1e-4, 1);
  options.Add("grasp.max_speed", &max_speed, "m/s, object, after it").Range(1e-6, 100);
  options.Add("grasp.max_spin", &max_spin, "rad/s, object, after it").Range(1e-6, 1000);
  options.Add("grasp.certify", &certify, "engine on which grasps must hold besides sim.engine")
      .Choices({"none", "ode", "lanes", "mujoco"});
  options.Add("grasp.certify_substeps", &certify_substeps, "its physics steps per control step")
      .Range(1, 64);
}

void GraspOptions::Check(const HandModel& hand) const {
  const auto expect = [](const char* name, std::size_t found, std::size_t size) {
    if (found != size)
      throw UsageError(fmt::format("grasp.{}: expected {} numbers, found {}", name, size, found));
  };
  expect("open_pose", open_pose.size(), hand.joints.size());
  expect("open_noise", open_noise.size(), hand.joints.size());
  expect("position_noise", position_noise.size(), 3);
  expect("squeeze", squeeze.size(), 2);
  if (hand.chains.size() < 2)
    Fail("{}: expected at least two fingers to grasp with, found {}", hand.source,
         hand.chains.size());
}

std::string GraspCounts::Text() const {
  std::string text =
      fmt::format("{} tried: {} blocked, {} without grip, {} dropped, {} moving, {} accepted",
                  tried, blocked, no_grip, dropped, moving, accepted);
  if (certified + refused > 0)
    text += fmt::format(", {} certified, {} refused", certified, refused);
  return text;
}

GraspSet TryFindGrasps(const GraspOptions& options, const TaskOptions& task, const SimOptions& sim,
                       const HandModel& hand, const SimObject& object, std::uint64_t seed,
                       ThreadPool& pool, GraspCounts* counts) {
  options.Check(hand);
  task.Check();
  const auto engine = MakeBatchSim(sim, hand, {object}, kRound, pool);
  Round round(options, task, sim, hand, *engine);
  std::optional<internal::Certifier> certifier;
  if (options.certify != "none") certifier.emplace(options, task, sim, hand, object, kRound, pool);
  const std::uint64_t key = internal::ObjectKey(object.name);
  *counts = {};
  GraspSet set;
  Progress progress(object.name, options.count);
  while (static_cast<int>(set.grasps.size()) < options.count &&
         counts->tried < options.candidates) {
    std::vector<FoundGrasp> found;
    round.Run(seed, key, counts->tried, *counts, found);
    if (certifier) DropRefused(*certifier, *counts, found);
    for (const FoundGrasp& one : found) set.grasps.push_back(one.grasp);
    progress.Update(std::min<double>(set.grasps.size(), options.count));
  }
  progress.Finish();
  set.acceptance = static_cast<double>(set.grasps.size()) / counts->tried;
  if (static_cast<int>(set.grasps.size()) > options.count) set.grasps.resize(options.count);
  return set;
}

GraspSet FindGrasps(const GraspOptions& options, const TaskOptions& task, const SimOptions& sim,
                    const HandModel& hand, const SimObject& object, std::uint64_t seed,
                    ThreadPool& pool, GraspCounts* counts) {
  GraspSet set = TryFindGrasps(options, task, sim, hand, object, seed, pool, counts);
  if (set.grasps.empty()) Fail("{}: no grasp found: {}", object.name, counts->Text());
  return set;
}

}  // namespace dexremoe
