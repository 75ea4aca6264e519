// Domain randomisation: what differs from episode to episode in training, and the noise within one
// (OpenAI et al. 2018, "Learning Dexterous In-Hand Manipulation", appendix B). Off by default.
//
// An episode draws one value of every parameter of the table from its range; DR keeps the ranges,
// ADR moves them (rl/adr.h). For noises the value is the standard deviation.
//
// NOTE(paper): DexReMoE names DR and ADR and no ranges. Of OpenAI's list these are missing: masses
// of the hand's links (the engines share one hand), motor backlash and random time steps.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/options.h"

namespace dexremoe {

enum class Distribution { kUniform, kLogUniform };

struct RandomParameter {
  const char* name;
  const char* help;  // what it is, with its unit
  Distribution spread;
  double low, high;    // DR's range
  double nominal;      // without randomisation; ADR starts there
  double least, most;  // ADR's limits
  double step;         // by which ADR moves a bound; of the logarithm for kLogUniform
};

// Position in kRandomParameters.
enum RandomIndex {
  kSize,
  kMass,
  kFriction,
  kDamping,
  kStiffness,
  kGravity,
  kJointLimit,
  kPositionBias,
  kPositionNoise,
  kRotationBias,
  kRotationNoise,
  kJointNoise,
  kActionNoise,
  kActionGain,
  kActionDelay,
  kForceRate,
  kForce,
  kNumRandom
};

inline constexpr std::array<RandomParameter, kNumRandom> kRandomParameters = {{
    {"size", "object size, factor", Distribution::kUniform, 0.95, 1.05, 1, 0.9, 1.1, 0.01},
    {"mass", "object mass, factor", Distribution::kUniform, 0.5, 1.5, 1, 0.2, 3, 0.05},
    {"friction", "friction, factor", Distribution::kUniform, 0.7, 1.3, 1, 0.3, 2, 0.05},
    {"damping", "servo damping, factor", Distribution::kLogUniform, 0.3, 3, 1, 0.1, 10, 0.1},
    {"stiffness", "servo stiffness, factor", Distribution::kLogUniform, 0.75, 1.5, 1, 0.3, 3, 0.05},
    {"gravity", "deviation of gravity per axis, m/s^2", Distribution::kUniform, 0.4, 0.4, 0, 0, 2,
     0.05},
    {"joint_limit", "deviation of the targets' limits, rad", Distribution::kUniform, 0.15, 0.15, 0,
     0, 0.4, 0.02},
    {"position_bias", "deviation of the seen position, fixed in an episode, m",
     Distribution::kUniform, 0.005, 0.005, 0, 0, 0.02, 0.0005},
    {"position_noise", "deviation of the seen position, at every decision, m",
     Distribution::kUniform, 0.001, 0.001, 0, 0, 0.01, 0.0002},
    {"rotation_bias", "deviation of the seen orientation, fixed in an episode, rad",
     Distribution::kUniform, 0.1, 0.1, 0, 0, 0.3, 0.01},
    {"rotation_noise", "deviation of the seen orientation, at every decision, rad",
     Distribution::kUniform, 0.1, 0.1, 0, 0, 0.3, 0.01},
    {"joint_noise", "deviation of the seen joint angles, rad", Distribution::kUniform, 0.02, 0.02,
     0, 0, 0.1, 0.002},
    {"action_noise", "deviation added to actions, 1", Distribution::kUniform, 0.05, 0.05, 0, 0, 0.5,
     0.01},
    {"action_gain", "deviation of a factor on actions, 1", Distribution::kUniform, 0.015, 0.015, 0,
     0, 0.2, 0.005},
    {"action_delay", "chance that an episode's actions come a control step late",
     Distribution::kUniform, 0.5, 0.5, 0, 0, 1, 0.05},
    {"force_rate", "chance per 80 ms that the force on the object is drawn anew",
     Distribution::kLogUniform, 0.001, 0.1, 0.01, 0.001, 0.3, 0.1},
    {"force", "deviation per axis of that force over the object's mass, m/s^2",
     Distribution::kUniform, 1, 1, 0, 0, 5, 0.1},
}};

struct RandomOptions {
  RandomOptions();  // DR's ranges
  bool on = false;
  std::array<std::vector<double>, kNumRandom> range;  // low, high
  // Share of episodes that have one parameter at a bound of its range (ADR); see DrawBound.
  double boundary_share = 0;
  void Register(Options& options);  // section "random"
  void Check() const;               // throws UsageError
};

// Bounds by number: 2 i is the lower one of parameter i, 2 i + 1 the upper one.
// Whether ADR may move it: lower bounds of deviations stay at zero.
constexpr bool BoundMoves(int bound) {
  const RandomParameter& p = kRandomParameters[bound / 2];
  return bound % 2 == 0 ? p.least < p.nominal : p.nominal < p.most;
}

}  // namespace dexremoe
