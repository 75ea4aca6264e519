// Success and reward of one control step, as plain arithmetic.
#pragma once

#include "task/reorient.h"

namespace dexremoe {

// What the rules look at. Velocities are finite differences at the control rate: a policy can
// exploit readings from inside the step.
struct StepFacts {
  double angle = 0;               // rotation distance to the goal, rad
  double previous_angle = 0;      // to the same goal one control step before, rad
  double distance = 0;            // |dp| from the goal position, m
  double speed = 0;               // object, m/s
  double spin = 0;                // object, rad/s
  double max_joint_speed = 0;     // rad/s
  double excess_joint_speed = 0;  // sum over joints of max(0, |qd| - joint_speed_clip), rad/s
  double squared_action = 0;      // |a|^2
  bool success = false;
  bool fall = false;
  bool jam = false;  // goal_timeout ran out
};

// All conditions of a success at this control step (holding them is counted by the caller).
bool MeetsGoal(const TaskOptions& options, const StepFacts& facts);

// Eq. 2, times reward_scale.
double Reward(const TaskOptions& options, const StepFacts& facts);

}  // namespace dexremoe
