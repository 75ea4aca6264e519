#include "rl/stage.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <thread>

#include "base/error.h"
#include "base/log.h"
#include "io/file_lock.h"
#include "rl/checkpoint.h"
#include "rl/reorient_env.h"
#include "rl/run_files.h"
#include "rl/trainer.h"

namespace dexremoe {
namespace {

// The learner's options, with the length that its schedules go by.
PpoOptions Learning(const StageOptions& stage, const StageKind& kind) {
  PpoOptions ppo = stage.ppo;
  ppo.span = kind.inputs.empty() ? stage.samples : 0;
  return ppo;
}

void PutFirst(const std::string& name, const std::string& list, std::vector<ObjectEntry>& entries) {
  if (name.empty()) return;
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const ObjectEntry& entry) { return entry.name == name; });
  if (found == entries.end())
    Fail("{}: expected the first object '{}' among those of split train, found none", list, name);
  std::rotate(entries.begin(), found, found + 1);
}

std::vector<ObjectEntry> SelectObjects(const StageOptions& stage, const StageKind& kind) {
  for (const std::string& category : kind.categories) CategoryIndex(category);
  std::vector<ObjectEntry> entries = ReadObjectList(stage.objects);
  std::erase_if(entries, [&](const ObjectEntry& entry) {
    const auto& wanted = kind.categories;
    return entry.split != "train" || (!wanted.empty() && std::find(wanted.begin(), wanted.end(),
                                                                   entry.category) == wanted.end());
  });
  if (entries.empty())
    Fail("{}: expected objects of split train{}, found none", stage.objects,
         kind.categories.empty()
             ? ""
             : fmt::format(" and category {}", fmt::join(kind.categories, ", ")));
  PutFirst(kind.first_object, stage.objects, entries);
  if (static_cast<std::size_t>(stage.ppo.envs) < entries.size())
    Fail("ppo.envs: expected at least one environment for each of {} objects, found {}",
         entries.size(), stage.ppo.envs);
  return entries;
}

void CheckSizes(const TrainState& state, const VecEnv& env, const std::string& path) {
  const PolicyStructure& s = state.structure;
  const auto check = [&](const char* field, int expected, int found) {
    if (expected != found)
      Fail("{}: structure/{}: expected {} for this hand, found {}", path, field, expected, found);
  };
  check("obs_size", env.obs_size(), s.obs_size);
  check("phys_size", env.phys_size(), s.phys_size);
  check("num_actions", env.num_actions(), s.num_actions);
}

// "base.h5" -> "base.best.h5", unless the user names another.
std::string BestPath(const StageOptions& stage) {
  if (!stage.best.empty()) return stage.best;
  return std::filesystem::path(stage.out).replace_extension(".best.h5");
}

// Where the run begins: at the checkpoint it left, or at the stage's first state.
TrainState FirstState(const StageOptions& stage, const Options& options, const StageKind& kind,
                      const StageStart& start, const VecEnv& env, const Communicator& ranks) {
  if (stage.resume && std::filesystem::exists(stage.out)) {
    CheckSameOptions(stage.out, options.Text());
    TrainState state = ReadCheckpoint(stage.out);
    if (state.table.names != start.table.names || state.table.feature != start.table.feature)
      Fail("{}: table: expected the objects of {}, found others; start anew without --resume",
           stage.out, stage.objects);
    const int processes = static_cast<int>(state.environment.size());
    if (processes > 0 && processes != ranks.size())
      Fail("{}: environment_end: expected a run of {} processes as now, found one of {}", stage.out,
           ranks.size(), processes);
    if (!std::filesystem::exists(BestPath(stage))) state.best = {};  // taken away: find it anew
    LogInfo("resuming {} at iteration {}, {} samples", stage.out, state.iteration, state.samples);
    return state;
  }
  TrainState state = kind.start(start, env.obs_size(), env.phys_size(), env.num_actions());
  state.card = DescribeMethod(state.stage, state.structure, start.ppo);
  CheckSizes(state, env, kind.inputs.empty() ? stage.out : kind.inputs.front());
  return state;
}

std::string ProgressNote(const CurveRow& row, const IterationTime& time, double samples) {
  return fmt::format(
      "S {:.2f} per episode, {:.2f} per 600, drop {:.2f}, |dp| {:.1f} mm, {:.2f} rad, "
      "return {:.1f}, kl {:.3f}, rate {:.1e}, {:.0f} samples/s",
      row[2], row[3], row[4], 1e3 * row[5], row[6], row[8], row[10], row[11],
      samples / (time.rollout + time.update));
}

// `files` on rank 0 only; the ranks decide as one when to save and when to stop.
void Train(const StageOptions& stage, Trainer& trainer, std::optional<RunFiles>& files,
           Communicator& ranks, const std::atomic<bool>& stop) {
  Progress progress(trainer.state().stage, stage.samples);
  const auto save = [&] {
    const TrainState& last = trainer.Snapshot();
    if (files) files->Save(last);
    ranks.Barrier();  // no rank ends before the files are whole
  };
  while (static_cast<double>(trainer.state().samples) < stage.samples) {
    const double before = static_cast<double>(trainer.state().samples);
    const CurveRow& row = trainer.Iterate();
    const double samples = static_cast<double>(trainer.state().samples) - before;
    if (files) {
      files->Add(trainer, samples);
      progress.Update(std::min(before + samples, stage.samples),
                      ProgressNote(row, trainer.time(), samples));
    }
    std::array<double, 2> wishes = {stop ? 1.0 : 0.0, files && files->Due() ? 1.0 : 0.0};
    ranks.Sum(wishes);
    if (wishes[0] + wishes[1] > 0) save();
    if (wishes[0] > 0)
      Fail(
          "stopped at {} of {:.0f} samples; {} is written; the same command with --resume=true "
          "continues it",
          trainer.state().samples, stage.samples, stage.out);
  }
  progress.Finish();
  save();
}

// Threads of this rank: those asked for, or its share of the machine's processors.
int Workers(const StageOptions& stage, const Communicator& ranks) {
  if (stage.workers > 0) return stage.workers;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / ranks.local_size());
}

int EnvsPerRank(const StageOptions& stage, const Communicator& ranks) {
  if (stage.ppo.envs % ranks.size() != 0)
    Fail("ppo.envs: expected a multiple of {} processes, found {}", ranks.size(), stage.ppo.envs);
  return stage.ppo.envs / ranks.size();
}

// Everything that the training rests on, for the provenance.
std::vector<std::string> Inputs(const StageOptions& stage, const StageKind& kind,
                                const std::vector<ObjectEntry>& entries) {
  std::vector<std::string> inputs = {stage.objects, stage.hand.urdf};
  inputs.insert(inputs.end(), kind.inputs.begin(), kind.inputs.end());
  for (const ObjectEntry& entry : entries) inputs.push_back(entry.grasps);
  return inputs;
}

}  // namespace

void StageOptions::Register(Options& options) {
  options.Add("objects", &objects, "objects.csv: those of split train are used").Required();
  options.Add("out", &out, "checkpoint to write (HDF5)").Required().NotStored();
  options.Add("best", &best, "checkpoint of the best state; none: NAME.best.h5 beside --out")
      .NotStored();
  options.Add("curve", &curve, "learning curve to write (CSV)").NotStored();
  options.Add("tensorboard", &tensorboard, "folder for TensorBoard's event files").NotStored();
  options.Add("snapshots", &snapshots, "folder for the states on the way").NotStored();
  options.Add("snapshot_samples", &snapshot_samples, "samples between those")
      .Range(1, 1e15)
      .NotStored();
  options.Add("samples", &samples, "environment steps to train for").Required().Range(0, 1e15);
  options.Add("seed", &seed, "of all random streams");
  options.Add("workers", &workers, "threads (of each process); 0: as many as processors")
      .Range(0, 1024)
      .NotStored();
  options.Add("resume", &resume, "continue from --out when it exists").NotStored();
  options.Add("checkpoint_minutes", &checkpoint_minutes, "minutes between checkpoints")
      .Range(0, 1e6)
      .NotStored();
  hand.Register(options);
  sim.Register(options);
  task.Register(options);
  ppo.Register(options);
}

TrainState RunStage(const StageOptions& stage, const Options& options, const StageKind& kind,
                    Communicator& ranks, const std::atomic<bool>& stop) {
  stage.ppo.Check();
  if (ranks.rank() > 0) SetLogLevel(LogLevel::kWarning);  // one voice is enough
  std::optional<FileLock> lock;  // a killed launcher may have left a training behind
  if (ranks.rank() == 0) lock.emplace(stage.out);
  ThreadPool pool(Workers(stage, ranks));
  const std::vector<ObjectEntry> entries = SelectObjects(stage, kind);
  const std::vector<TaskObject> objects = LoadObjects(entries, {.cloud_points = kind.cloud_points});
  const HandModel hand = LoadHand(stage.hand);
  const int envs = EnvsPerRank(stage, ranks);
  ReorientBatch batch(stage.task, stage.sim, hand, objects, envs, stage.seed, pool);
  batch.PlaceIn(ranks.rank() * envs, stage.ppo.envs);
  ReorientEnv env(batch);
  const PpoOptions ppo = Learning(stage, kind);
  const StageStart start = {ppo,
                            {.goal_angle = stage.task.goal_angle,
                             .velocity_tolerance = stage.task.velocity_tolerance,
                             .gravity_factor = stage.task.gravity_factor,
                             .near_share = stage.task.near_share},
                            MakeShapeTable(objects, FeatureSize(kind.cloud_points)),
                            stage.seed};
  Trainer trainer(ppo, start.task, FirstState(stage, options, kind, start, env, ranks), env, pool,
                  ranks, stage.adr);
  std::optional<RunFiles> files;
  if (ranks.rank() == 0)
    files.emplace(
        RunPaths{stage.out, BestPath(stage), stage.curve, stage.tensorboard, stage.snapshots},
        MakeProvenance(options, stage.seed, Inputs(stage, kind, entries)),
        RunPeriods{stage.checkpoint_minutes, stage.snapshot_samples}, trainer.state());
  LogInfo("{}: {} objects, {} environments, {} parameters of which {} in training",
          trainer.state().stage, objects.size(), stage.ppo.envs, trainer.policy().layout().size(),
          TrainableSet(trainer.policy().layout(), trainer.policy().trainable()).size());
  const MethodCard& card = trainer.state().card;
  LogInfo("inputs: {}; network: {}", card.inputs, card.network);
  LogInfo("losses beside PPO's: {}; curriculum: {}; samples: {:.0f}", card.losses, card.curriculum,
          stage.samples);
  if (ranks.size() > 1) LogInfo("{} processes with {} threads each", ranks.size(), pool.workers());
  Train(stage, trainer, files, ranks, stop);
  TrainState state = trainer.state();
  state.environment.clear();
  return state;
}

std::string StageSummary(const StageOptions& stage, const TrainState& state) {
  std::string text = fmt::format("{}: {} samples", stage.out, state.samples);
  if (state.curve.empty()) return text;
  const CurveRow& row = state.curve.back();
  return text + fmt::format(
                    ", {:.3f} successes per episode, {:.3f} per 600 steps, drop rate {:.3f}, "
                    "mean |dp| {:.1f} mm, mean angle {:.3f} rad, return {:.2f} "
                    "(last {:.0f} episodes, with exploration)",
                    row[2], row[3], row[4], 1e3 * row[5], row[6], row[8], row[9]);
}

}  // namespace dexremoe
