// The task: N hands turn N objects to one random goal orientation after another (paper, section
// IV).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/options.h"
#include "base/random.h"
#include "base/thread_pool.h"
#include "sim/batch_sim.h"
#include "task/object_set.h"
#include "task/randomization.h"

namespace dexremoe {

struct TaskOptions {
  // Episode (paper, Table II).
  int episode_length = 600;  // control steps
  // Control steps without a success after which an episode fails; 0: never. NOTE(paper): not there.
  // For training alone: a jammed object teaches little while the clock runs out, and hovering near
  // a goal would be paid for.
  int goal_timeout = 0;
  double fall_distance = 0.12;  // m from the grasp centre; ends the episode
  std::vector<double> grasp_center = {0.0, 0.064, 0.11};  // m in W
  double scale = 1.0;  // size factor beside the one of scale_mesh
  // Success (paper, section IV-A).
  double tolerance = 0.4;       // rad
  double joint_speed_max = 10;  // rad/s, each joint
  double speed_max = 0.04;      // m/s
  double spin_max = 0.5;        // rad/s
  int hold_steps = 1;           // control steps all conditions must hold
  // Reward (paper, eq. 2), all times reward_scale.
  double c_success = 800, c_dist = -10, c_rot = 1, c_action = -0.0002;
  double c_joint_speed = -0.05, joint_speed_clip = 5, epsilon = 0.1;
  double reward_scale = 0.01;
  double c_progress = 0;  // NOTE(paper): not there; times (theta_prev - theta)
  double c_fall = 0;      // NOTE(paper): not there; once, at a fall
  double c_jam = 0;       // NOTE(paper): not there; once, when goal_timeout runs out
  // Actions: relative targets behind a moving average.
  double action_scale = 0.1;  // rad per control step at a = 1
  double ema = 1.0;           // alpha
  double target_leash = 0.3;  // rad, targets stay this close to the joint
  // NOTE(paper): one control step. Longer actions learn more from each sample.
  int action_repeat = 1;  // control steps that an action lasts (one decision)
  // What o_t shows of the last three commands: "action" (the averaged action that was executed) or
  // "target" (the joint targets, scaled like the joints; what the paper's lineage shows).
  std::string observe = "action";
  // The goal is shown at most this far from the present orientation, on the way to it, rad; pi and
  // more shows it as it is. NOTE(paper): not there; far goals then look like near ones, which a
  // small budget learns first.
  double goal_shown = 3.1416;
  // What e_phys shows besides the paper's 23 numbers; see PhysSize.
  std::vector<std::string> extra_inputs;
  // Goals: Haar-uniform, or within goal_angle of the present orientation (a curriculum).
  double goal_angle = 3.1416;  // rad; pi and more means Haar
  // NOTE(paper): not there. For training alone: this share of the goals lies within near_angle, so
  // that successes stay frequent while goal_angle widens.
  double near_share = 0;
  double near_angle = 1.2;        // rad
  double velocity_tolerance = 1;  // factor on speed_max and spin_max (a curriculum)
  // Factor on gravity in episodes to come (a curriculum); below 0 objects fall into the palm.
  // NOTE(paper): not there.
  double gravity_factor = 1;
  // Episodes to come draw on the first so many objects, interleaved; 0: an environment keeps its
  // object (a curriculum).
  int objects_in_use = 0;
  // Physical parameters drawn per episode: uniform in [low, high]. The size is the grasp's: it was
  // drawn from scale_range when the grasp was found.
  std::vector<double> mass_range = {0.06, 0.10};  // kg
  std::vector<double> friction_range = {0.9, 1.1};
  // NOTE(paper): silent.
  std::vector<double> torsion_range = {0.0, 0.0};  // m, torsional friction; 0: point contacts
  std::vector<double> scale_range = {1.0, 1.0};
  std::vector<double> com_range = {0.0, 0.0};  // m, offset of the centre of mass, each axis
  // Domain randomisation, beside the ranges above.
  RandomOptions random;
  void Register(Options& options);  // section "task"
  void Check() const;               // throws UsageError for malformed lists

 private:
  void RegisterEpisode(Options& options);  // its end, and what a success is
  void RegisterReward(Options& options);
  void RegisterPolicySide(Options& options);  // actions and what is shown
  void RegisterDraws(Options& options);       // goals and physical parameters
};

// e_phys (paper, section III-B): mass 1 (kg), centre of mass 3 (m, O), friction 1, scale 1,
// position 3 (m, W), orientation 4 (w >= 0), velocity 3 (m/s, W), spin 3 (rad/s, W) and
// q_WO * conj(q_WG) 4 (w >= 0).
// NOTE(paper): the listed parts sum to 19 of 23, and without the goal the policy cannot know its
// target, so the missing 4 are taken to be the relative quaternion.
inline constexpr int kPhysSize = 23;

// Length of a row of e_phys: the paper's 23 numbers, then what options.extra_inputs names, in this
// order whatever the order there. NOTE(paper): none of these is in the paper.
//   "goal_vector"   3: rotation vector that turns the object to its goal, rad, W
//   "joint_speed"   J: joint speeds over the last control step, rad/s
//   "tip_position"  3 a finger: fingertip frame's origin less the object's position, m, W
//   "tip_contact"   1 a finger: 1 when its tip touches the object
//   "wait_clock"    2: sine and cosine of the time since the last success (or the start), with a
//                   period of kWaitPeriod. Without it a policy without memory, once it jams, does
//                   the same for ever.
inline constexpr int kWaitPeriod = 180;  // control steps
int PhysSize(const TaskOptions& options, const HandModel& hand);
// Columns of such a row that joint sensors, a camera that follows the object and a clock would
// give: orientation, position, the goal, joint speeds, where the tips are; not the object's
// properties, its velocities and what touches it.
std::vector<int> ObservableColumns(const TaskOptions& options, const HandModel& hand);

// kJam: goal_timeout ran out. Only a timeout leaves the value of the state to be counted on.
enum class EpisodeEnd : std::uint8_t { kNone, kFall, kTimeout, kJam };

// What one Step gives, row = environment.
struct StepResult {
  std::vector<float> reward;          // [N], already times reward_scale
  std::vector<EpisodeEnd> end;        // [N]; the environment has been reset when not kNone
  std::vector<std::uint8_t> success;  // [N]
  // Observations of the state before the reset of ended episodes, for the bootstrap at a timeout:
  // rows of environments whose episode ended, in order of environment.
  std::vector<int> ended;
  std::vector<float> last_obs, last_phys;  // [ended, obs_size], [ended, phys_size]
};

// Figures of an ended episode.
struct EpisodeRecord {
  int env = 0;
  int object = 0;
  std::uint64_t episode = 0;  // number that addressed the random streams
  int length = 0;             // control steps lived
  int successes = 0;
  EpisodeEnd end = EpisodeEnd::kNone;
  double total_reward = 0;   // sum of scaled rewards
  double mean_angle = 0;     // rad, mean over steps of the distance to the goal
  double mean_distance = 0;  // m, mean |dp|
  int bound = -1;  // of the randomisation's range that it stood at (see BoundMoves), or none
  // Control steps up to its end that the object did not turn while fingers pressed it; only
  // evaluations look (eval/outcome.h), -1: nobody did.
  int still = -1;
};

class ReorientBatch {
 public:
  // Environment env gets object env % objects.size() (interleaved, so that every minibatch sees
  // all) unless Reset says otherwise. Every object needs grasps of this hand, found at a scale that
  // `task` allows. Throws Error naming the object. `pool` must outlive the batch.
  ReorientBatch(const TaskOptions& task, const SimOptions& sim, const HandModel& hand,
                std::vector<TaskObject> objects, int num_envs, std::uint64_t seed,
                ThreadPool& pool);
  // The same on a simulator of the caller's that holds `objects` in this order.
  ReorientBatch(const TaskOptions& task, const SimOptions& sim_options, const HandModel& hand,
                std::vector<TaskObject> objects, std::unique_ptr<BatchSim> sim, std::uint64_t seed,
                ThreadPool& pool);
  ~ReorientBatch();

  int num_envs() const;
  int num_joints() const;  // = action size
  int obs_size() const;    // 6 * num_joints (66)
  int phys_size() const;   // PhysSize
  int action_repeat() const;
  const std::vector<TaskObject>& objects() const;
  const SimState& sim_state() const;

  // All randomness of an episode (grasp, physical parameters, goals) is drawn from streams
  // addressed by the object's name and the episode's number: in whichever environment or batch it
  // runs, it is the same episode.

  // Makes these environments first .. first + num_envs - 1 of a batch of `total` that is spread
  // over processes: from the next ResetAll on they get the objects and episodes they would have
  // there.
  void PlaceIn(int first, int total);
  int first_env() const;
  // Starts a new episode everywhere: environment env gets number first_env + env, and the automatic
  // reset after it `total` more, so numbers never repeat.
  void ResetAll();
  // Starts episode `episode` with object `object` in env (evaluation assigns these itself).
  void Reset(int env, int object, std::uint64_t episode);

  // One decision: action_repeat control steps with the same actions [N, num_joints], clamped to
  // [-1, 1]; rewards are summed. Ended episodes are reset (auto_reset) or left where they are and
  // no longer stepped.
  const StepResult& Step(const std::vector<float>& actions);
  void set_auto_reset(bool on);

  // Observation before the next action, row = environment: o_t and e_phys (paper, section III-B).
  // o_t: joint angles at t-2, t-1, t, each scaled so that its limits are -1 and 1, then the
  // commands at t-3, t-2, t-1 (see TaskOptions::observe); t counts decisions.
  const std::vector<float>& obs() const;                   // [N, obs_size]
  const std::vector<float>& phys() const;                  // [N, phys_size]
  const std::vector<int>& object() const;                  // [N]
  const std::vector<std::array<double, 4>>& goal() const;  // [N] w x y z in W
  // Rotation distance to the goal, rad, and |dp|, m.
  const std::vector<double>& angle() const;
  const std::vector<double>& distance() const;

  const EnvPhysics& physics(int env) const;    // of the running episode
  const std::vector<double>& targets() const;  // [N, num_joints] servo targets, rad

  // Episodes that ended since the last call, in order of step and environment.
  std::vector<EpisodeRecord> TakeRecords();

  // Curricula change these while running.
  TaskOptions& mutable_options();

  // Pushes on the object: force in N in W, drawn by the caller; applied during the next step.
  void Push(int env, const Eigen::Vector3d& force);

  // Everything that changes while running, bit for bit (checkpoints), the options that curricula
  // change included. Restore throws Error when the image is of another batch.
  std::vector<std::uint8_t> Save() const;
  void Restore(const std::vector<std::uint8_t>& bytes);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dexremoe
