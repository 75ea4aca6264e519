#include "rl/checkpoint.h"

#include <sstream>

#include "base/error.h"
#include "policy/policy.h"
#include "rl/checkpoint_fields.h"

namespace dexremoe {
namespace {

void WriteOptimizer(H5Writer& file, const TrainState& state, const Policy<float>& policy) {
  file.Write("trainable", policy.trainable(),
             {static_cast<std::int64_t>(policy.trainable().size())},
             {"1", "block", "1 where training may change the block"});
  const std::int64_t dense = static_cast<std::int64_t>(state.adam.m.size());
  file.Write("adam/m", state.adam.m, {dense}, {"1", "parameter", "Adam: mean of gradients"});
  file.Write("adam/v", state.adam.v, {dense}, {"1", "parameter", "Adam: mean of squares"});
  file.WriteScalar("adam/step", state.adam.step, {"1", "", "Adam: steps taken"});
  file.WriteScalar("learning_rate", state.learning_rate, {"1", "", "Adam: next rate"});
}

void WriteRun(H5Writer& file, const TrainState& state) {
  file.WriteScalar("iteration", state.iteration, {"1", "", "rollouts and updates done"});
  WriteCurriculum(file, state.curriculum);
  WriteAdr(file, state.adr);
  WriteWindow(file, state.window);
  WriteBest(file, state);
  WriteCurve(file, state.curve);
  WriteEnvironment(file, state.environment);
}

void ReadOptimizer(const H5Reader& file, const Policy<float>& policy, TrainState& state) {
  std::int64_t dense = 0;
  const auto trainable = file.ReadValues<std::uint8_t>(
      "trainable", {static_cast<std::int64_t>(policy.layout().blocks().size())});
  for (std::size_t i = 0; i < trainable.size(); ++i) {
    const ParamBlock& block = policy.layout().block(static_cast<int>(i));
    if (trainable[i] != policy.trainable()[i])
      Fail("{}: trainable: block {}: expected {}, found {}", file.path(), block.name,
           policy.trainable()[i], trainable[i]);
    if (trainable[i]) dense += block.size();
  }
  state.adam.step = file.ReadScalar<std::int64_t>("adam/step");
  if (state.adam.step == 0) dense = 0;
  state.adam.m = file.ReadValues<float>("adam/m", {dense});
  state.adam.v = file.ReadValues<float>("adam/v", {dense});
  state.learning_rate = file.ReadScalar<double>("learning_rate");
}

void ReadRun(const H5Reader& file, TrainState& state) {
  state.iteration = file.ReadScalar<std::int64_t>("iteration");
  state.curriculum = ReadCurriculum(file);
  state.adr = ReadAdr(file);
  state.window = ReadWindow(file);
  ReadBest(file, state);
  state.curve = ReadCurve(file);
  state.environment = ReadEnvironment(file);
}

std::string OptionName(const std::string& line) { return line.substr(0, line.find(" = ")); }

}  // namespace

void WriteCheckpoint(const std::string& path, const TrainState& state,
                     const Provenance& provenance) {
  H5Writer file(path, kCheckpointFormat, provenance);
  WritePolicyPart(file, state);
  WriteOptimizer(file, state, *MakePolicy<float>(state.structure));
  WriteRun(file, state);
  file.Commit();
}

TrainState ReadCheckpoint(const std::string& path) {
  const H5Reader file(path, kCheckpointFormat);
  TrainState state;
  ReadPolicyPart(file, state);
  ReadOptimizer(file, *MakePolicy<float>(state.structure), state);
  ReadRun(file, state);
  return state;
}

void CheckSameOptions(const std::string& path, const std::string& options) {
  const H5Reader file(path, kCheckpointFormat);
  std::istringstream then(file.Attribute("options")), now(options);
  std::string was, is;
  for (;;) {
    const bool more_then = static_cast<bool>(std::getline(then, was));
    const bool more_now = static_cast<bool>(std::getline(now, is));
    if (!more_then && !more_now) return;
    if (more_then != more_now)
      Fail("{}: options: expected as many as now, found {} at '{}'; start anew without --resume",
           path, more_then ? "more" : "fewer", more_then ? was : is);
    if (was != is && !(OptionName(was) == "samples" && OptionName(is) == "samples"))
      Fail("{}: options: expected '{}' as now, found '{}'; start anew without --resume", path, is,
           was);
  }
}

}  // namespace dexremoe
