// Runs evaluation episodes: the same number for every object, equal whatever the number of
// environments or threads.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/options.h"
#include "eval/eval_file.h"
#include "eval/trace.h"
#include "rl/policy_runner.h"
#include "task/reorient.h"

namespace dexremoe {

struct EvalOptions {
  int episodes = 60;                            // per object (paper: 6000 over 100 objects)
  int envs = 256;                               // run together; the results do not depend on it
  std::vector<double> tolerances = {0.4, 0.1};  // rad
  double push = 0;                              // N; a push lasts one control step
  int push_every = 60;                          // control steps between pushes
  int resamples = 2000;                         // of the bootstrap
  // What policies are told of the category: "label"; what PointNet++ takes each object for
  // ("predicted"); or the probabilities of all ("soft").
  std::string category = "label";
  void Register(Options& options);  // section "eval"
};

// Episode `episode` with object `object`; the pair addresses all random streams of the episode.
struct EpisodeJob {
  int object = 0;
  std::uint64_t episode = 0;
};
// Object by object, `episodes` each.
std::vector<EpisodeJob> MakeJobs(int objects, int episodes);

// Writes actions [N, num_joints] for the batch's present observations.
using ActFunction = std::function<void(const ReorientBatch& batch, std::vector<float>& actions)>;
// The policy's means, rounded alike in whatever batch an environment stands: the matrix library
// takes other paths for a few rows than for many, so the batch is filled up to whole blocks.
// `runner` must outlive the function.
ActFunction PolicyActions(PolicyRunner& runner);
// No actions: the servos keep the targets of the grasp. The least that a policy has to beat.
ActFunction HoldActions();

// Called before every step with the actions about to be taken and after it with its result.
struct StepObserver {
  std::function<void(const ReorientBatch&, const std::vector<float>& actions)> before;
  std::function<void(const StepResult&)> after;
};

struct PushOptions {
  double force = 0;  // N
  int every = 60;    // control steps
};

// Runs every job once in the environments of `batch` (environment e starts with job e, and takes
// the next one waiting when its episode ends). Returns the records in order of jobs.
std::vector<EpisodeRecord> RunJobs(ReorientBatch& batch, const ActFunction& act,
                                   const std::vector<EpisodeJob>& jobs, const PushOptions& push,
                                   std::uint64_t seed, const StepObserver& observer = {},
                                   const std::function<void(int done)>& progress = {});

// Everything that stays the same over the tolerances.
struct EvalSetup {
  TaskOptions task;
  SimOptions sim;
  HandModel hand;
  std::vector<TaskObject> objects;
  std::uint64_t seed = 0;
};

// Fills category_input of the objects from the logits in the shape.h5 of their entries, as `choice`
// (EvalOptions::category) says; labels stay as they are. Throws Error.
void SetCategoryInput(const std::string& choice, const std::vector<ObjectEntry>& entries,
                      std::vector<TaskObject>& objects);

// The task of an evaluation: setup.task at this tolerance, without the settings that serve training
// alone (goal_timeout, near_share).
TaskOptions EvalTask(const EvalSetup& setup, double tolerance);

// All tolerances: one run of episodes each. Shows progress on stderr.
std::vector<EvalRun> Evaluate(const EvalSetup& setup, const EvalOptions& options,
                              const ActFunction& act, ThreadPool& pool);

// Which episodes of a run to record: "best" and "worst" by successes, at most one per object until
// every object has one; "first" is episode 0 of the first objects. Ties go to the longer (best) or
// the earlier job. "typical" is one of each object, those of fewest successes first: of the kind of
// failure (fall or jam) that it ends in most often, the one of median length; without a failure, of
// all its episodes.
std::vector<EpisodeJob> ChooseEpisodes(const EvalRun& run, int count, const std::string& choice);

// Runs chosen episodes of a run once more and records them. `gates` is [objects, E] or empty.
// Throws Error when a replayed episode differs from the recorded one.
std::vector<EpisodeTrace> RecordEpisodes(const EvalSetup& setup, const EvalOptions& options,
                                         const EvalRun& run, const std::vector<EpisodeJob>& jobs,
                                         const ActFunction& act, const std::vector<float>& gates,
                                         ThreadPool& pool);

}  // namespace dexremoe
