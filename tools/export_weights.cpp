// What a checkpoint acts with, without its training: the files that are shipped.
#include <cstdio>
#include <string>

#include "base/error.h"
#include "base/options.h"
#include "rl/policy_file.h"

int main(int argc, char** argv) {
  using namespace dexremoe;
  std::string policy, out;
  Options options(
      "export_weights",
      "Strips a checkpoint to its weights (dexremoe.weights): what evaluation, t-SNE and "
      "films take, and nothing of its training. Prints method,samples,seed.",
      "export_weights --policy=gate.h5 --out=pretrained/gate.h5");
  options.Add("policy", &policy, "checkpoint of any stage or method").Required();
  options.Add("out", &out, "weights to write").Required().NotStored();
  return RunTool(options, argc, argv, [&] {
    const TrainState state = ReadPolicy(policy);
    ExportWeights(policy, out, MakeProvenance(options, state.seed, {policy}));
    std::puts(fmt::format("{},{},{}", state.stage, state.samples, state.seed).c_str());
  });
}
