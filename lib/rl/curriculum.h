// Goals come nearer, the speed rule is looser and objects weigh less at first; all move to the
// paper's task as the policy succeeds. Then the goals are near no more often than the task says
// and, with options.curriculum_objects, more objects follow. Falls get dearer with samples alone.
#pragma once

#include <cstdint>
#include <vector>

#include "rl/env.h"
#include "rl/ppo_options.h"

namespace dexremoe {

// Whole state, stored in checkpoints.
struct CurriculumState {
  TaskDifficulty difficulty;
  bool angle_next = true;      // which of the two moves next
  std::int64_t samples = 0;    // since the last decision
  std::int64_t episodes = 0;   // ended since the last decision
  std::int64_t successes = 0;  // in those
};

// NOTE(paper): it has no curriculum. With a full-sphere goal and the strict speed rule from the
// first step, small sample budgets stay at the level of chance. Decisions rest on successes per
// episode, not per step: the latter would reward dropping the object soon.
class Curriculum {
 public:
  // `task` is the difficulty it ends at, with `objects` in all. Without options.curriculum that is
  // the state throughout.
  Curriculum(const PpoOptions& options, const TaskDifficulty& task, int objects = 0);

  CurriculumState Start() const;
  // Accounts for one iteration; returns true when the difficulty changed.
  bool Update(std::int64_t samples, const std::vector<EpisodeRecord>& records,
              CurriculumState& state) const;
  // Sets near_share, which follows from goals and speeds, and fall_share, which follows from the
  // samples so far: they are in no checkpoint.
  void Complete(std::int64_t samples, TaskDifficulty& now) const;

 private:
  bool AngleOpen(const TaskDifficulty& now) const;  // not the task's yet
  bool VelocityOpen(const TaskDifficulty& now) const;
  bool Advance(CurriculumState& state) const;
  PpoOptions options_;
  TaskDifficulty task_;
  int objects_;
};

}  // namespace dexremoe
