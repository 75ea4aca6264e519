// A method that the paper compares itself with, at equal samples and reward (lib/rl/baseline.h).
#include <cstdio>
#include <optional>

#include "base/error.h"
#include "rl/baseline.h"
#include "rl/checkpoint.h"
#include "rl/stage.h"
#include "rl/stop_signal.h"

using namespace dexremoe;

namespace {

// What the method itself settles, whatever the configuration says.
void Prepare(const std::string& method, const std::string& base, StageOptions& stage) {
  if (StartsFromBase(method) == base.empty())
    throw UsageError(fmt::format("--base: expected {} for --method={}",
                                 base.empty() ? "a checkpoint of train_base" : "none", method));
  stage.adr.Check();
  if (!Randomizes(method)) return;
  stage.task.random.on = true;
  stage.ppo.curriculum = true;
  if (stage.ppo.curriculum_objects == 0) stage.ppo.curriculum_objects = 1;
  stage.adr.on = method == "adr";
  if (stage.adr.on) stage.task.random.boundary_share = stage.adr.boundary_share;
}

}  // namespace

int main(int argc, char** argv) {
  Options options("train_baseline", "Train a baseline or a control with PPO.",
                  "train_baseline --method=switch --objects=objects.csv --out=switch.h5 "
                  "--curve=switch.csv --samples=3e6 --config=data/config/desk.toml");
  StageOptions stage;
  StageKind kind;
  PolicyOptions policy;
  std::string method, base;
  options.Add("method", &method, "which one")
      .Required()
      .Choices({"dr", "adr", "privfeat", "privshape", "res", "sparse_moe", "switch", "mlore",
                "mmoe", "base_long"});
  options.Add("base", &base, "checkpoint of train_base, for res and base_long; its samples count");
  options.Add("first_object", &kind.first_object, "dr, adr: object to begin with; none: the first");
  stage.Register(options);
  stage.adr.Register(options);
  policy.Register(options);
  return RunTool(options, argc, argv, [&] {
    Prepare(method, base, stage);
    std::optional<TrainState> parent;
    if (!base.empty()) {
      parent = ReadCheckpoint(base);
      kind.inputs = {base};
    }
    kind.cloud_points = parent ? parent->structure.cloud_points : policy.cloud_points;
    const std::vector<int> observable = ObservableColumns(stage.task, LoadHand(stage.hand));
    kind.start = [&](const StageStart& start, int obs_size, int phys_size, int num_actions) {
      return StartBaseline(method, start, policy, obs_size, phys_size, num_actions, observable,
                           parent ? &*parent : nullptr, base);
    };
    const auto ranks = StartCommunicator();
    const TrainState state = RunStage(stage, options, kind, *ranks, CatchStopSignals());
    if (ranks->rank() == 0) std::puts(StageSummary(stage, state).c_str());
  });
}
