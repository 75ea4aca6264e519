// How true the engines are: to closed forms, and to MuJoCo at short steps as the referee. The
// numbers of `validate_sim`.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/options.h"
#include "eval/sim_rollout.h"
#include "eval/sim_setting.h"
#include "eval/sim_table.h"

namespace dexremoe {

struct SimValidationOptions {
  int grasps = 64;             // wanted per engine and shape
  int candidates = 512;        // tried for them at most
  int episodes = 384;          // under random targets, per setting and shape
  int referee_substeps = 17;   // MuJoCo at about 1 ms
  double noise = 1;            // of the random targets, see TargetWalk
  double fall_distance = 0.1;  // m from task.grasp_center; ends an episode
  std::uint64_t seed = 1;
  void Register(Options& options);  // without a section
  void MakeQuick();                 // sizes that take seconds
};

// ---- Motion without contact ----

// One second of free fall from rest against g t^2 / 2 and g t.
struct FallError {
  double position = 0, velocity = 0;  // m, m/s
};
FallError FreeFallError(const SimOptions& sim, ThreadPool& pool);

// A block spinning about its middle axis, where it tumbles, for one second: relative changes.
struct TumbleError {
  double momentum = 0, energy = 0;
};
TumbleError TumbleErrors(const SimOptions& sim, ThreadPool& pool);

// Joint angles [steps * J] after each control step of a hand without object. Every joint starts in
// the middle of its range and its target jumps by `amplitude` rad, up and down in turn.
std::vector<double> JointStepResponse(const SimOptions& sim, const HandModel& hand,
                                      double amplitude, int steps, ThreadPool& pool);

// ---- Friction ----

// Angle, rad, of the steepest board on which a flat block stays (moves slower than 5 mm/s after a
// third of a second), in steps of 0.1 degrees. `direction`: of the slope within the board, rad.
double SlipAngle(const SimOptions& sim, double friction, double direction, ThreadPool& pool);

// ---- Grasps ----

// What becomes of grasps in one second under gravity, targets kept, of task.mass_range's middle.
struct HoldFigures {
  int tried = 0;
  int held = 0;   // the object is within 3 cm of where it was
  int quiet = 0;  // and below the success thresholds: root mean square of the speed and the spin
                  // over the last half second, by finite difference at the control rate
  void Add(const HoldFigures& other);
  double HeldShare() const { return tried == 0 ? NAN : static_cast<double>(held) / tried; }
  double QuietShare() const { return held == 0 ? NAN : static_cast<double>(quiet) / held; }
};
HoldFigures HoldGrasps(const SimOptions& sim, const HandModel& hand, const TaskOptions& task,
                       const GraspedObject& object, double friction, ThreadPool& pool);

// ---- Random targets ----

struct SurvivalFigures {
  double steps = 0, error = 0;  // mean control steps until the fall, at most 600; standard error
  // Deepest hand-object contact of an environment at the end of a control step, over all steps with
  // contact, as the engine reports it; m.
  double depth_95 = 0, depth_99 = 0, depth_max = 0;
};
// `episodes` episodes from the object's grasps in turn. Targets and starts are the same for every
// engine.
SurvivalFigures Survive(const SimOptions& sim, const HandModel& hand, const TaskOptions& task,
                        const GraspedObject& object, const SimValidationOptions& options,
                        ThreadPool& pool);

// ---- All of it ----

// Settings compared when only these engines run here; the referee, if it runs, is the last.
std::vector<EngineSetting> ValidationSettings(const std::vector<std::string>& engines,
                                              const SimValidationOptions& options);

struct SimValidation {
  std::vector<Measurement> measurements;
  std::string notes;  // engines left out, one a line
  std::string Markdown() const;
};
// Equal for any number of workers.
SimValidation ValidateSim(const SimValidationOptions& options, const HandModel& hand,
                          const TaskOptions& task, std::span<const SimObject> shapes,
                          ThreadPool& pool);

}  // namespace dexremoe
