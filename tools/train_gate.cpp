// The gate: soft weights of the frozen experts by shape, trained with PPO on all training objects
// (paper, III-E, algorithm 1).
#include <cstdio>

#include "rl/checkpoint.h"
#include "rl/stage.h"
#include "rl/stop_signal.h"

using namespace dexremoe;

int main(int argc, char** argv) {
  Options options("train_gate", "Train the gate over frozen experts (DexReMoE's last stage).",
                  "train_gate --experts=expert_all.h5,expert_airplane.h5 --objects=objects.csv "
                  "--out=gate.h5 --samples=1e6");
  StageOptions stage;
  StageKind kind;
  PolicyOptions policy;
  options.Add("experts", &kind.inputs, "checkpoints of train_expert, in the order of the weights")
      .Required();
  stage.Register(options);
  policy.Register(options);
  return RunTool(options, argc, argv, [&] {
    std::vector<TrainState> experts;
    for (const std::string& path : kind.inputs) experts.push_back(ReadCheckpoint(path));
    kind.cloud_points = experts.front().structure.cloud_points;
    kind.start = [&](const StageStart& start, int, int, int) {
      return StartGate(start, policy, experts, kind.inputs);
    };
    const auto ranks = StartCommunicator();
    const TrainState state = RunStage(stage, options, kind, *ranks, CatchStopSignals());
    if (ranks->rank() == 0) std::puts(StageSummary(stage, state).c_str());
  });
}
