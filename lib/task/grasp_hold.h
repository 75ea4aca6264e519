// When a grasp holds, and the second engine that has to agree. Internal to lib/task.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/batch_sim.h"
#include "task/grasp_search.h"

namespace dexremoe::internal {

// The conditions of GraspOptions on the state of an environment.
class HoldRule {
 public:
  // The arguments must outlive the rule.
  HoldRule(const GraspOptions& options, const TaskOptions& task, const HandModel& hand,
           double control_rate)
      : options_(options), task_(task), hand_(hand), control_rate_(control_rate) {}

  bool Touches(const SimState& state, int env, std::size_t finger) const;
  // The thumb and at least one other finger touch.
  bool Gripped(const SimState& state, int env) const;
  bool Near(const SimState& state, int env) const;
  // Over the control step from `before` to `now`.
  bool AtRest(const SimState& before, const SimState& now, int env) const;

 private:
  const GraspOptions& options_;
  const TaskOptions& task_;
  const HandModel& hand_;
  double control_rate_;  // Hz
};

struct FoundGrasp {
  Grasp grasp;
  EnvPhysics physics;  // it was found with
};

// Replays grasps on the engine options.certify at options.certify_substeps.
class Certifier {
 public:
  // Replays at most `capacity` grasps at a time. The arguments must outlive the certifier.
  Certifier(const GraspOptions& options, const TaskOptions& task, const SimOptions& sim,
            const HandModel& hand, const SimObject& object, int capacity, ThreadPool& pool);

  // For each grasp 1 when the hand, started at rest in it with its targets and its physical
  // parameters, keeps the object for hold_steps: near all the time, at rest and gripped at the end.
  std::vector<std::uint8_t> Certify(std::span<const FoundGrasp> found);

 private:
  const GraspOptions& options_;
  int joints_;
  HoldRule rule_;
  std::unique_ptr<BatchSim> sim_;
};

}  // namespace dexremoe::internal
