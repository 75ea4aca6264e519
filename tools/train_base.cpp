// The base policy: encoders and actor-critic trained jointly with PPO on all training objects
// (paper, III-C).
#include <cstdio>

#include "rl/stage.h"
#include "rl/stop_signal.h"

using namespace dexremoe;

int main(int argc, char** argv) {
  Options options("train_base", "Train the base policy with PPO.",
                  "train_base --objects=objects.csv --out=base.h5 --curve=base.csv --samples=2e6 "
                  "--config=data/config/desk.toml");
  StageOptions stage;
  PolicyOptions policy;
  stage.Register(options);
  policy.Register(options);
  return RunTool(options, argc, argv, [&] {
    StageKind kind;
    kind.cloud_points = policy.cloud_points;
    kind.start = [&](const StageStart& start, int obs_size, int phys_size, int num_actions) {
      return StartBase(start, policy, obs_size, phys_size, num_actions);
    };
    const auto ranks = StartCommunicator();
    const TrainState state = RunStage(stage, options, kind, *ranks, CatchStopSignals());
    if (ranks->rank() == 0) std::puts(StageSummary(stage, state).c_str());
  });
}
