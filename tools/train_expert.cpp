// An expert: the base policy trained on with frozen encoders, on some categories or on all (the
// generalist) (paper, III-D).
#include <cstdio>

#include "rl/checkpoint.h"
#include "rl/stage.h"
#include "rl/stop_signal.h"

using namespace dexremoe;

int main(int argc, char** argv) {
  Options options("train_expert", "Fine-tune the base policy to an expert; encoders stay frozen.",
                  "train_expert --base=base.h5 --objects=objects.csv --categories=airplane "
                  "--out=expert_airplane.h5 --samples=1e6");
  StageOptions stage;
  StageKind kind;
  std::string base;
  double share = 1;
  bool rate_of_base = true;
  options.Add("base", &base, "checkpoint of train_base").Required();
  options.Add("categories", &kind.categories, "categories to train on; none: all (generalist)");
  options.Add("share", &share, "factor on `samples`, where other numbers of experts share a total")
      .Range(0, 64);
  options.Add("rate_of_base", &rate_of_base,
              "start at the rate that the base had come to, where it adapts; else at "
              "ppo.learning_rate");
  stage.Register(options);
  return RunTool(options, argc, argv, [&] {
    stage.samples *= share;
    const TrainState parent = ReadCheckpoint(base);
    kind.inputs = {base};
    kind.cloud_points = parent.structure.cloud_points;
    kind.start = [&](const StageStart& start, int, int, int) {
      // A rate for a fresh network undoes what a base with little noise left has learned.
      StageStart own = start;
      if (rate_of_base && start.ppo.adaptive) own.ppo.learning_rate = parent.learning_rate;
      return StartExpert(own, parent, base);
    };
    const auto ranks = StartCommunicator();
    const TrainState state = RunStage(stage, options, kind, *ranks, CatchStopSignals());
    if (ranks->rank() == 0) std::puts(StageSummary(stage, state).c_str());
  });
}
