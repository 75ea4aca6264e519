#include "task/rules.h"

namespace dexremoe {

bool MeetsGoal(const TaskOptions& options, const StepFacts& facts) {
  // NOTE(paper): the text gives tolerance 0.1 and 0.4; 0.4 is the default, 0.1 is reported beside
  // it. NOTE(paper): 10 rad/s for each joint lies above the motors' 6.2 rad/s and so never binds.
  return facts.angle <= options.tolerance && facts.max_joint_speed <= options.joint_speed_max &&
         facts.speed <= options.velocity_tolerance * options.speed_max &&
         facts.spin <= options.velocity_tolerance * options.spin_max;
}

double Reward(const TaskOptions& options, const StepFacts& facts) {
  const double success = facts.success ? options.c_success : 0;
  // NOTE(paper): c_rot is printed as -1, which would reward being far from the goal; +1 here.
  // NOTE(paper): epsilon is not given; 0.1 as in the systems the reward descends from.
  const double pose =
      options.c_dist * facts.distance + options.c_rot / (facts.angle + options.epsilon);
  // NOTE(paper): c_joint_speed and the clip are not given.
  const double effort =
      options.c_joint_speed * facts.excess_joint_speed + options.c_action * facts.squared_action;
  const double extra = options.c_progress * (facts.previous_angle - facts.angle) +
                       (facts.fall ? options.c_fall : 0) + (facts.jam ? options.c_jam : 0);
  return options.reward_scale * (success + pose + effort + extra);
}

}  // namespace dexremoe
