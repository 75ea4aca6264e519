#include "rl/policy_file.h"

#include "base/error.h"
#include "io/hash.h"
#include "rl/checkpoint.h"
#include "rl/checkpoint_fields.h"

namespace dexremoe {
namespace {

bool IsWeights(const std::string& path) {
  return H5Reader(path).Attribute("format") == kWeightsFormat.name;
}

H5Reader Open(const std::string& path) {
  return H5Reader(path, IsWeights(path) ? kWeightsFormat : kCheckpointFormat);
}

std::string HashOfParams(const std::vector<float>& params) {
  return HashOf({reinterpret_cast<const char*>(params.data()), params.size() * sizeof(float)});
}

}  // namespace

void ExportWeights(const std::string& from, const std::string& path, const Provenance& provenance) {
  const H5Reader checkpoint(from, kCheckpointFormat);
  const TrainState state = ReadPolicy(from);
  H5Writer file(path, kWeightsFormat, provenance);
  WritePolicyPart(file, state);
  file.WriteString("params_hash", HashOfParams(state.params), {"", "", "of all parameters"});
  file.WriteString("training/tool", checkpoint.Attribute("tool"), {"", "", "that trained it"});
  file.WriteString("training/options", checkpoint.Attribute("options"), {"", "", "of that tool"});
  file.Commit();
}

TrainState ReadPolicy(const std::string& path) {
  const H5Reader file = Open(path);
  TrainState state;
  ReadPolicyPart(file, state);
  if (file.Has("params_hash")) {
    const std::string then = file.ReadString("params_hash"), now = HashOfParams(state.params);
    if (then != now) Fail("{}: params: expected hash {}, found {}", path, then, now);
  }
  return state;
}

PolicyStructure ReadPolicyStructure(const std::string& path) { return ReadStructure(Open(path)); }

}  // namespace dexremoe
