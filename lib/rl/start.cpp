#include "rl/start.h"

#include <algorithm>

#include "base/check.h"
#include "base/error.h"
#include "nn/precision.h"
#include "policy/policy.h"

namespace dexremoe {
namespace {

TrainState Common(const StageStart& start, const std::string& stage) {
  TrainState state;
  state.stage = stage;
  state.seed = start.seed;
  state.table = start.table;
  state.learning_rate = start.ppo.learning_rate;
  state.curriculum = Curriculum(start.ppo, start.task, start.table.objects()).Start();
  return state;
}

// A later stage goes on at the difficulty that the one before had reached.
CurriculumState Continue(const StageStart& start, const CurriculumState& before) {
  CurriculumState state = Curriculum(start.ppo, start.task, start.table.objects()).Start();
  if (start.ppo.curriculum) {
    state.difficulty = before.difficulty;
    state.angle_next = before.angle_next;
  }
  return state;
}

bool Same(const RunningMoments& a, const RunningMoments& b) {
  return a.mean == b.mean && a.variance == b.variance && a.count == b.count;
}

// Copies the blocks of `from` whose names start with `prefix` to those of `to` under `new_prefix`.
void CopyBlocks(const ParamLayout& from, const std::vector<float>& from_params,
                const std::string& prefix, const ParamLayout& to, const std::string& new_prefix,
                std::vector<float>& to_params) {
  for (const ParamBlock& block : from.blocks()) {
    if (!block.name.starts_with(prefix)) continue;
    const int index = to.Find(new_prefix + block.name.substr(prefix.size()));
    DEX_CHECK_GE(index, 0);
    DEX_CHECK_EQ(to.block(index).size(), block.size());
    std::copy_n(from_params.begin() + block.offset, block.size(),
                to_params.begin() + to.block(index).offset);
  }
}

bool SameBlocks(const ParamLayout& layout, const std::string& prefix, const std::vector<float>& a,
                const std::vector<float>& b) {
  return std::all_of(layout.blocks().begin(), layout.blocks().end(), [&](const ParamBlock& block) {
    return !block.name.starts_with(prefix) ||
           std::equal(a.begin() + block.offset, a.begin() + block.offset + block.size(),
                      b.begin() + block.offset);
  });
}

void CheckIsExpert(const TrainState& state, const std::string& path) {
  if (state.structure.kind != "actor_critic")
    Fail("{}: structure/kind: expected actor_critic, found {}", path, state.structure.kind);
}

// Experts of one base: same widths, same encoders, same input moments.
void CheckSameBase(const ParamLayout& layout, const TrainState& first,
                   const std::string& first_path, const TrainState& other,
                   const std::string& path) {
  CheckIsExpert(other, path);
  const PolicyStructure &a = first.structure, &b = other.structure;
  if (a.obs_size != b.obs_size || a.phys_size != b.phys_size || a.num_actions != b.num_actions ||
      a.feature_size != b.feature_size || a.cloud_widths != b.cloud_widths ||
      a.extrinsics_widths != b.extrinsics_widths || a.z_size != b.z_size || a.hidden != b.hidden)
    Fail("{}: structure: expected the widths of {}, found others", path, first_path);
  if (!SameBlocks(layout, "encoder/", first.params, other.params))
    Fail("{}: params/encoder: expected those of {} (experts of one base), found others", path,
         first_path);
  if (!Same(first.normalizers.obs, other.normalizers.obs) ||
      !Same(first.normalizers.phys, other.normalizers.phys) ||
      !Same(first.normalizers.feature, other.normalizers.feature))
    Fail("{}: normalizer: expected that of {} (experts of one base), found another", path,
         first_path);
}

}  // namespace

TrainState StartFresh(const StageStart& start, const PolicyOptions& options,
                      const PolicyStructure& structure, const std::string& stage) {
  TrainState state = Common(start, stage);
  state.structure = structure;
  state.structure.precision = ResolvePrecision(start.ppo.precision);
  const auto policy = MakePolicy<float>(state.structure);
  state.params.resize(policy->layout().size());
  policy->Initialize(start.seed, options.log_std, options.mean_scale, state.params.data());
  state.normalizers.obs = RunningMoments(structure.obs_size);
  state.normalizers.phys = RunningMoments(structure.phys_size);
  state.normalizers.feature = RunningMoments(structure.feature_size);
  state.normalizers.clip = start.ppo.obs_clip;
  if (structure.cloud_points == 0)  // points are of unit size, and one network maps them all
    UpdateMoments(start.table.objects(), start.table.feature.data(), state.normalizers.feature);
  return state;
}

TrainState StartBase(const StageStart& start, const PolicyOptions& options, int obs_size,
                     int phys_size, int num_actions) {
  return StartFresh(start, options, options.Base(obs_size, phys_size, num_actions), "base");
}

TrainState StartResidual(const StageStart& start, const PolicyOptions& options,
                         const TrainState& base, const std::string& path) {
  CheckIsExpert(base, path);
  TrainState state = Common(start, "res");
  state.structure = base.structure;
  state.structure.kind = "residual";
  state.structure.train_encoders = false;
  state.structure.precision = ResolvePrecision(start.ppo.precision);
  const auto from = MakePolicy<float>(base.structure), to = MakePolicy<float>(state.structure);
  state.params.resize(to->layout().size());
  to->Initialize(start.seed, options.log_std, options.mean_scale, state.params.data());
  for (const char* blocks : {"encoder/", "actor/", "log_std"})
    CopyBlocks(from->layout(), base.params, blocks, to->layout(), blocks, state.params);
  state.normalizers = base.normalizers;
  state.curriculum = Continue(start, base.curriculum);
  state.samples = base.samples;
  return state;
}

TrainState ContinueBase(const StageStart& start, const TrainState& base, const std::string& path) {
  CheckIsExpert(base, path);
  if (base.table.names != start.table.names || base.table.feature != start.table.feature)
    Fail("{}: table: expected the objects of this training, found others", path);
  TrainState state = base;
  state.stage = "base_long";
  state.seed = start.seed;
  state.structure.precision = ResolvePrecision(start.ppo.precision);
  state.environment.clear();
  return state;
}

TrainState StartExpert(const StageStart& start, const TrainState& base, const std::string& path) {
  CheckIsExpert(base, path);
  TrainState state = Common(start, "expert");
  state.structure = base.structure;
  state.structure.train_encoders = false;
  state.structure.precision = ResolvePrecision(start.ppo.precision);
  state.params = base.params;
  state.normalizers = base.normalizers;
  state.curriculum = Continue(start, base.curriculum);
  return state;
}

TrainState StartGate(const StageStart& start, const PolicyOptions& options,
                     const std::vector<TrainState>& experts,
                     const std::vector<std::string>& paths) {
  DEX_CHECK(!experts.empty());
  DEX_CHECK_EQ(experts.size(), paths.size());
  const TrainState& first = experts.front();
  CheckIsExpert(first, paths.front());
  const auto expert = MakePolicy<float>(first.structure);
  for (std::size_t i = 1; i < experts.size(); ++i)
    CheckSameBase(expert->layout(), first, paths.front(), experts[i], paths[i]);

  TrainState state = Common(start, "gate");
  state.structure = options.Mixture(first.structure, static_cast<int>(experts.size()));
  state.structure.precision = ResolvePrecision(start.ppo.precision);
  state.normalizers = first.normalizers;
  state.curriculum = Continue(start, first.curriculum);
  const auto mixture = MakePolicy<float>(state.structure);
  state.params.resize(mixture->layout().size());
  mixture->Initialize(start.seed, 0, 1, state.params.data());
  CopyBlocks(expert->layout(), first.params, "encoder/", mixture->layout(), "encoder/",
             state.params);
  float* log_std = state.params.data() + mixture->layout().block(mixture->log_std_block()).offset;
  const ParamBlock& spread = expert->layout().block(expert->log_std_block());
  for (std::size_t i = 0; i < experts.size(); ++i) {
    CopyBlocks(expert->layout(), experts[i].params, "actor/", mixture->layout(),
               "expert" + std::to_string(i) + "/", state.params);
    for (std::int64_t a = 0; a < spread.size(); ++a)
      log_std[a] += experts[i].params[spread.offset + a] / static_cast<float>(experts.size());
  }
  return state;
}

}  // namespace dexremoe
