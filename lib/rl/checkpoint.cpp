#include "rl/checkpoint.h"

#include <sstream>

#include "base/error.h"
#include "policy/policy.h"
#include "rl/checkpoint_fields.h"

namespace dexremoe {
namespace {

void WriteMoments(H5Writer& file, const std::string& name, const RunningMoments& moments) {
  const std::vector<std::int64_t> dims = {static_cast<std::int64_t>(moments.mean.size())};
  const std::string prefix = "normalizer/" + name;
  file.Write(prefix + "/mean", moments.mean, dims, {"1", "column", "running mean"});
  file.Write(prefix + "/variance", moments.variance, dims, {"1", "column", "running variance"});
  file.WriteScalar(prefix + "/count", moments.count, {"1", "", "rows seen"});
}

RunningMoments ReadMoments(const H5Reader& file, const std::string& name, int columns) {
  RunningMoments moments(columns);
  const std::string prefix = "normalizer/" + name;
  moments.mean = file.ReadValues<double>(prefix + "/mean", {columns});
  moments.variance = file.ReadValues<double>(prefix + "/variance", {columns});
  moments.count = file.ReadScalar<double>(prefix + "/count");
  return moments;
}

void WriteNetwork(H5Writer& file, const TrainState& state, const Policy<float>& policy) {
  WriteStructure(file, state.structure);
  std::vector<std::string> names;
  for (const ParamBlock& block : policy.layout().blocks()) {
    names.push_back(block.name);
    const auto begin = state.params.begin() + block.offset;
    file.Write("params/" + block.name, std::vector<float>(begin, begin + block.size()),
               {block.rows, block.cols}, {"1", "output, input", "network parameters"});
  }
  const std::int64_t blocks = static_cast<std::int64_t>(names.size());
  file.WriteStrings("block", names, {"1", "block", "parameter blocks in order"});
  file.Write("trainable", policy.trainable(), {blocks},
             {"1", "block", "1 where training may change the block"});
  const std::int64_t dense = static_cast<std::int64_t>(state.adam.m.size());
  file.Write("adam/m", state.adam.m, {dense}, {"1", "parameter", "Adam: mean of gradients"});
  file.Write("adam/v", state.adam.v, {dense}, {"1", "parameter", "Adam: mean of squares"});
  file.WriteScalar("adam/step", state.adam.step, {"1", "", "Adam: steps taken"});
  file.WriteScalar("learning_rate", state.learning_rate, {"1", "", "Adam: next rate"});
  WriteMoments(file, "obs", state.normalizers.obs);
  WriteMoments(file, "phys", state.normalizers.phys);
  WriteMoments(file, "feature", state.normalizers.feature);
  WriteMoments(file, "value", state.normalizers.value);
  file.WriteScalar("normalizer/clip", state.normalizers.clip,
                   {"1", "", "limit of normalised inputs"});
}

void WriteRun(H5Writer& file, const TrainState& state) {
  file.WriteString("stage", state.stage, {"", "", "base, expert, gate or a baseline"});
  file.WriteScalar("seed", state.seed, {"1", "", "of all random streams"});
  file.WriteScalar("iteration", state.iteration, {"1", "", "rollouts and updates done"});
  file.WriteScalar("samples", state.samples, {"1", "", "environment steps done"});
  WriteCard(file, state.card);
  WriteCurriculum(file, state.curriculum);
  WriteAdr(file, state.adr);
  WriteWindow(file, state.window);
  WriteBest(file, state);
  WriteCurve(file, state.curve);
  WriteEnvironment(file, state.environment);
  const std::int64_t objects = state.table.objects();
  const std::int64_t width = objects > 0 ? state.table.feature.size() / objects : 0;
  file.WriteStrings("table/name", state.table.names, {"", "object", "objects trained on"});
  file.Write("table/feature", state.table.feature, {objects, width},
             {"1", "object, component", "shape descriptor p, not normalised"});
  file.Write("table/category", state.table.category, {objects}, {"1", "object", "category index"});
}

void ReadNetwork(const H5Reader& file, const Policy<float>& policy, TrainState& state) {
  state.params.resize(policy.layout().size());
  std::int64_t dense = 0;
  const auto trainable = file.ReadValues<std::uint8_t>(
      "trainable", {static_cast<std::int64_t>(policy.layout().blocks().size())});
  for (std::size_t i = 0; i < trainable.size(); ++i) {
    const ParamBlock& block = policy.layout().block(static_cast<int>(i));
    const auto values = file.ReadValues<float>("params/" + block.name, {block.rows, block.cols});
    std::copy(values.begin(), values.end(), state.params.begin() + block.offset);
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
  state.normalizers.obs = ReadMoments(file, "obs", state.structure.obs_size);
  state.normalizers.phys = ReadMoments(file, "phys", state.structure.phys_size);
  state.normalizers.feature = ReadMoments(file, "feature", state.structure.feature_size);
  state.normalizers.value = ReadMoments(file, "value", 1);
  state.normalizers.clip = file.ReadScalar<double>("normalizer/clip");
}

void ReadRun(const H5Reader& file, TrainState& state) {
  state.seed = file.ReadScalar<std::uint64_t>("seed");
  state.iteration = file.ReadScalar<std::int64_t>("iteration");
  state.samples = file.ReadScalar<std::int64_t>("samples");
  state.card = ReadCard(file);
  state.curriculum = ReadCurriculum(file);
  state.adr = ReadAdr(file);
  state.window = ReadWindow(file);
  ReadBest(file, state);
  state.curve = ReadCurve(file);
  state.environment = ReadEnvironment(file);
  state.table.names = file.ReadStrings("table/name");
  const std::int64_t objects = state.table.objects();
  state.table.feature =
      file.ReadValues<float>("table/feature", {objects, state.structure.feature_size});
  state.table.category = file.ReadValues<std::int32_t>("table/category", {objects});
}

std::string OptionName(const std::string& line) { return line.substr(0, line.find(" = ")); }

}  // namespace

void WriteCheckpoint(const std::string& path, const TrainState& state,
                     const Provenance& provenance) {
  const auto policy = MakePolicy<float>(state.structure);
  H5Writer file(path, kCheckpointFormat, provenance);
  WriteNetwork(file, state, *policy);
  WriteRun(file, state);
  WriteExample(file, MakeExample(state, *policy));
  file.Commit();
}

TrainState ReadCheckpoint(const std::string& path) {
  const H5Reader file(path, kCheckpointFormat);
  TrainState state;
  state.stage = file.ReadString("stage");
  state.structure = ReadStructure(file);
  std::unique_ptr<Policy<float>> policy;
  try {
    policy = MakePolicy<float>(state.structure);
  } catch (const Error& error) {
    Fail("{}: {}", path, error.what());
  }
  ReadNetwork(file, *policy, state);
  ReadRun(file, state);
  CheckExample(file, MakeExample(state, *policy));
  return state;
}

PolicyStructure ReadPolicyStructure(const std::string& path) {
  return ReadStructure(H5Reader(path, kCheckpointFormat));
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
