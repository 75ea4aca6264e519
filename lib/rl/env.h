// What training needs of a task: many environments stepped together.
#pragma once

#include <cstdint>
#include <vector>

#include "task/reorient.h"

namespace dexremoe {

// The settings a curriculum may loosen; see TaskOptions.
struct TaskDifficulty {
  double goal_angle = 3.1416;     // rad; pi and more: any goal
  double velocity_tolerance = 1;  // factor on the speeds a success allows
  double gravity_factor = 1;      // of the episodes to come
  int objects = 0;                // the first of the list, in use; 0: all, from the start
  double near_share = 0;          // of the goals
  double fall_share = 1;          // of task.c_fall that a fall costs
};

class VecEnv {
 public:
  virtual ~VecEnv() = default;

  virtual int num_envs() const = 0;
  // Number of environment 0 among those of all ranks; addresses random streams.
  virtual int first_env() const { return 0; }
  virtual int obs_size() const = 0;
  virtual int phys_size() const = 0;
  virtual int num_actions() const = 0;

  virtual void ResetAll() = 0;
  // actions [N, num_actions], not clamped. Ended episodes are reset.
  virtual const StepResult& Step(const std::vector<float>& actions) = 0;
  // Rows of the present state; valid until the next Step.
  virtual const std::vector<float>& obs() const = 0;   // [N, obs_size]
  virtual const std::vector<float>& phys() const = 0;  // [N, phys_size]
  virtual const std::vector<int>& object() const = 0;  // [N]
  // Episodes that ended since the last call.
  virtual std::vector<EpisodeRecord> TakeRecords() = 0;

  virtual void SetDifficulty(const TaskDifficulty& difficulty) = 0;
  // Ranges of the randomised parameters [kNumRandom], for episodes to come.
  virtual void SetRandomRanges(const std::vector<double>& /*low*/,
                               const std::vector<double>& /*high*/) {}

  // Everything, bit for bit.
  virtual std::vector<std::uint8_t> Save() const = 0;
  virtual void Restore(const std::vector<std::uint8_t>& bytes) = 0;
};

}  // namespace dexremoe
