// What checkpoints and files of weights have in common: the policy and what it was trained on.
#include <algorithm>

#include "base/error.h"
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

void WriteParams(H5Writer& file, const TrainState& state, const ParamLayout& layout) {
  std::vector<std::string> names;
  for (const ParamBlock& block : layout.blocks()) {
    names.push_back(block.name);
    const auto begin = state.params.begin() + block.offset;
    file.Write("params/" + block.name, std::vector<float>(begin, begin + block.size()),
               {block.rows, block.cols}, {"1", "output, input", "network parameters"});
  }
  file.WriteStrings("block", names, {"1", "block", "parameter blocks in order"});
}

void WriteTable(H5Writer& file, const ShapeTable& table) {
  const std::int64_t objects = table.objects();
  const std::int64_t width = objects > 0 ? table.feature.size() / objects : 0;
  file.WriteStrings("table/name", table.names, {"", "object", "objects trained on"});
  file.Write("table/feature", table.feature, {objects, width},
             {"1", "object, component", "shape descriptor p, not normalised"});
  file.Write("table/category", table.category, {objects}, {"1", "object", "category index"});
}

ShapeTable ReadTable(const H5Reader& file, int feature_size) {
  ShapeTable table;
  table.names = file.ReadStrings("table/name");
  const std::int64_t objects = table.objects();
  table.feature = file.ReadValues<float>("table/feature", {objects, feature_size});
  table.category = file.ReadValues<std::int32_t>("table/category", {objects});
  return table;
}

std::unique_ptr<Policy<float>> BuildPolicy(const H5Reader& file, const PolicyStructure& structure) {
  try {
    return MakePolicy<float>(structure);
  } catch (const Error& error) {
    Fail("{}: {}", file.path(), error.what());
  }
}

}  // namespace

void WritePolicyPart(H5Writer& file, const TrainState& state) {
  const auto policy = MakePolicy<float>(state.structure);
  file.WriteString("stage", state.stage, {"", "", "base, expert, gate or a baseline"});
  file.WriteScalar("seed", state.seed, {"1", "", "of all random streams"});
  file.WriteScalar("samples", state.samples, {"1", "", "environment steps done"});
  WriteCard(file, state.card);
  WriteStructure(file, state.structure);
  WriteParams(file, state, policy->layout());
  WriteMoments(file, "obs", state.normalizers.obs);
  WriteMoments(file, "phys", state.normalizers.phys);
  WriteMoments(file, "feature", state.normalizers.feature);
  WriteMoments(file, "value", state.normalizers.value);
  file.WriteScalar("normalizer/clip", state.normalizers.clip,
                   {"1", "", "limit of normalised inputs"});
  WriteTable(file, state.table);
  WriteExample(file, MakeExample(state, *policy));
}

void ReadPolicyPart(const H5Reader& file, TrainState& state) {
  state.stage = file.ReadString("stage");
  state.structure = ReadStructure(file);
  const auto policy = BuildPolicy(file, state.structure);
  state.params.resize(policy->layout().size());
  for (const ParamBlock& block : policy->layout().blocks()) {
    const auto values = file.ReadValues<float>("params/" + block.name, {block.rows, block.cols});
    std::copy(values.begin(), values.end(), state.params.begin() + block.offset);
  }
  state.normalizers.obs = ReadMoments(file, "obs", state.structure.obs_size);
  state.normalizers.phys = ReadMoments(file, "phys", state.structure.phys_size);
  state.normalizers.feature = ReadMoments(file, "feature", state.structure.feature_size);
  state.normalizers.value = ReadMoments(file, "value", 1);
  state.normalizers.clip = file.ReadScalar<double>("normalizer/clip");
  state.seed = file.ReadScalar<std::uint64_t>("seed");
  state.samples = file.ReadScalar<std::int64_t>("samples");
  state.card = ReadCard(file);
  state.table = ReadTable(file, state.structure.feature_size);
  CheckExample(file, MakeExample(state, *policy));
}

}  // namespace dexremoe
