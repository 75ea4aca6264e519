#include "base/error.h"
#include "task/reorient.h"

namespace dexremoe {

void TaskOptions::Register(Options& options) {
  RegisterEpisode(options);
  RegisterReward(options);
  RegisterPolicySide(options);
  RegisterDraws(options);
}

void TaskOptions::RegisterEpisode(Options& options) {
  options.Add("task.episode_length", &episode_length, "control steps").Range(1, 1e6);
  options
      .Add("task.goal_timeout", &goal_timeout,
           "control steps without success that end an episode; 0: off")
      .Range(0, 1e6);
  options.Add("task.fall_distance", &fall_distance, "m from grasp_center; ends the episode")
      .Range(1e-3, 10);
  options.Add("task.grasp_center", &grasp_center, "goal position in W, m: x,y,z");
  options.Add("task.scale", &scale, "size factor beside the one of scale_mesh").Range(0.1, 10);
  options.Add("task.tolerance", &tolerance, "rotation distance of a success, rad").Range(1e-3, 3.2);
  options.Add("task.joint_speed_max", &joint_speed_max, "each joint, at a success, rad/s")
      .Range(1e-6, 1e6);
  options.Add("task.speed_max", &speed_max, "object, at a success, m/s").Range(1e-6, 1e6);
  options.Add("task.spin_max", &spin_max, "object, at a success, rad/s").Range(1e-6, 1e6);
  options.Add("task.hold_steps", &hold_steps, "control steps that a success must hold")
      .Range(1, 1e6);
}

void TaskOptions::RegisterReward(Options& options) {
  options.Add("task.c_success", &c_success, "reward of a success");
  options.Add("task.c_dist", &c_dist, "reward per m from grasp_center");
  options.Add("task.c_rot", &c_rot, "reward: c_rot / (angle + epsilon)");
  options.Add("task.c_action", &c_action, "reward per |a|^2");
  options.Add("task.c_joint_speed", &c_joint_speed, "reward per rad/s above joint_speed_clip");
  options.Add("task.joint_speed_clip", &joint_speed_clip, "rad/s").Range(0, 1e6);
  options.Add("task.epsilon", &epsilon, "rad").Range(1e-6, 10);
  options.Add("task.reward_scale", &reward_scale, "factor on every reward").Range(1e-9, 1e6);
  options.Add("task.c_progress", &c_progress, "reward per rad of progress");
  options.Add("task.c_fall", &c_fall, "reward of a fall");
  options.Add("task.c_jam", &c_jam, "reward when goal_timeout runs out");
}

void TaskOptions::RegisterPolicySide(Options& options) {
  options.Add("task.action_scale", &action_scale, "target increment at a = 1, rad per control step")
      .Range(0, 10);
  options.Add("task.ema", &ema, "weight of the new action in the moving average").Range(1e-3, 1);
  options.Add("task.target_leash", &target_leash, "largest |target - joint angle|, rad")
      .Range(1e-3, 10);
  options.Add("task.action_repeat", &action_repeat, "control steps that an action lasts")
      .Range(1, 60);
  options.Add("task.goal_shown", &goal_shown, "the goal is shown at most this far away, rad")
      .Range(1e-3, 10);
  options.Add("task.extra_inputs", &extra_inputs, "privileged inputs beside the paper's 23")
      .Choices({"goal_vector", "joint_speed", "tip_position", "tip_contact", "wait_clock"});
  options.Add("task.observe", &observe, "what o_t shows of the past commands")
      .Choices({"action", "target"});
}

void TaskOptions::RegisterDraws(Options& options) {
  options.Add("task.goal_angle", &goal_angle, "goals within this angle, rad; pi and more: any")
      .Range(1e-3, 10);
  options.Add("task.near_share", &near_share, "share of goals within task.near_angle").Range(0, 1);
  options.Add("task.near_angle", &near_angle, "rad").Range(1e-3, 10);
  options.Add("task.velocity_tolerance", &velocity_tolerance, "factor on speed_max and spin_max")
      .Range(1e-3, 1e6);
  options.Add("task.gravity_factor", &gravity_factor, "factor on gravity").Range(-10, 10);
  options.Add("task.mass_range", &mass_range, "kg: low,high");
  options.Add("task.friction_range", &friction_range, "hand-object coefficient: low,high");
  options.Add("task.torsion_range", &torsion_range,
              "torsional friction, moment about the normal over normal force, m: low,high");
  options.Add("task.scale_range", &scale_range, "size factor of grasp search: low,high");
  options.Add("task.com_range", &com_range, "centre-of-mass offset per axis, m: low,high");
  random.Register(options);
}

void TaskOptions::Check() const {
  if (grasp_center.size() != 3)
    throw UsageError(
        fmt::format("task.grasp_center: expected 3 numbers, found {}", grasp_center.size()));
  const auto range = [](const char* name, const std::vector<double>& r, double least) {
    if (r.size() != 2 || !(r[0] <= r[1]) || !(r[0] >= least))
      throw UsageError(fmt::format("task.{}: expected low,high with {} <= low <= high, found {}",
                                   name, least, fmt::join(r, ",")));
  };
  range("mass_range", mass_range, 1e-6);
  range("friction_range", friction_range, 0);
  range("torsion_range", torsion_range, 0);
  range("scale_range", scale_range, 1e-3);
  range("com_range", com_range, -1);
  random.Check();
}

}  // namespace dexremoe
