// Search for stable grasps: the starts of episodes.
#pragma once

#include <string>
#include <vector>

#include "base/options.h"
#include "base/thread_pool.h"
#include "sim/batch_sim.h"
#include "task/grasp_file.h"
#include "task/reorient.h"

namespace dexremoe {

struct GraspOptions {
  int count = 100;         // grasps per object
  int candidates = 20000;  // give up after so many
  // The open hand, rad, and half widths of the uniform noise on it (joint order of the hand).
  std::vector<double> open_pose = {1.85, -0.15, -0.10, 1.45,  0.0, -0.35,
                                   0.10, 1.45,  0.0,   -0.35, 0.10};
  std::vector<double> open_noise = {0.22, 0.12, 0.12, 0.12, 0.30, 0.12,
                                    0.12, 0.12, 0.30, 0.12, 0.12};
  std::vector<double> position_noise = {0.006, 0.006, 0.010};  // m, about grasp_center, half widths
  double close_rate = 1.8;  // rad/s of the closing joints' targets
  int close_steps = 50;     // control steps
  std::vector<double> squeeze = {0.08,
                                 0.20};  // rad beyond the joint once the tip touches: low,high
  int hold_steps = 60;         // control steps under gravity without action (paper: stable grasps)
  double max_distance = 0.03;  // m from grasp_center after holding
  double max_speed = 0.03;     // m/s, object, over the last control step
  double max_spin = 0.4;       // rad/s
  // Engine on which a grasp has to hold too, by the same conditions, before it is kept: "none",
  // "ode", "lanes" or "mujoco".
  std::string certify = "none";
  int certify_substeps = 2;
  void Register(Options& options);  // section "grasp"
  // Throws UsageError for lists that do not fit the hand.
  void Check(const HandModel& hand) const;
};

// Why candidates were dropped.
struct GraspCounts {
  int tried = 0;
  int blocked = 0;    // the open hand or the palm already touches the object
  int no_grip = 0;    // after closing, the thumb and another finger do not both touch
  int dropped = 0;    // slipped too far while holding
  int moving = 0;     // still near but not at rest, or held by fewer fingers
  int accepted = 0;   // beyond `count` too: counts are of whole rounds
  int certified = 0;  // of the accepted: hold on the certifying engine
  int refused = 0;    // of the accepted: do not hold there
  std::string Text() const;
};

// Closes the hand of `count` or more environments at a time around the held object at a
// Haar-uniform orientation, lets go, and keeps what stays. Chain 0 is the thumb; the last two
// joints of every chain close, in positive direction. Mass, friction, torsional friction and size
// are drawn from the task's ranges. Candidate number c draws from its own stream, so the result
// depends on the seed and the object's name alone. Throws Error naming the object, the candidates
// and the counts when none is found.
GraspSet FindGrasps(const GraspOptions& options, const TaskOptions& task, const SimOptions& sim,
                    const HandModel& hand, const SimObject& object, std::uint64_t seed,
                    ThreadPool& pool, GraspCounts* counts);

// The same, but gives an empty set when none is found.
GraspSet TryFindGrasps(const GraspOptions& options, const TaskOptions& task, const SimOptions& sim,
                       const HandModel& hand, const SimObject& object, std::uint64_t seed,
                       ThreadPool& pool, GraspCounts* counts);

}  // namespace dexremoe
