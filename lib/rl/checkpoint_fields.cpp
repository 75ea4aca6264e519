#include "rl/checkpoint_fields.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"

namespace dexremoe {
namespace {

constexpr int kExampleRows = 4;
constexpr int kWindowColumns = 9;
constexpr double kExampleTolerance = 1e-3;  // other processors round otherwise

void WriteWidths(H5Writer& file, const char* name, const std::vector<int>& widths) {
  file.Write(std::string("structure/") + name, widths, {static_cast<std::int64_t>(widths.size())},
             {"1", "layer", "layer widths"});
}

std::vector<int> ReadWidths(const H5Reader& file, const char* name) {
  return file.ReadValues<std::int32_t>(std::string("structure/") + name, {-1});
}

void WriteNumber(H5Writer& file, const char* name, int value) {
  file.WriteScalar(std::string("structure/") + name, value, {"1", "", "see PolicyStructure"});
}

int ReadNumber(const H5Reader& file, const char* name) {
  return file.ReadScalar<std::int32_t>(std::string("structure/") + name);
}

void CheckClose(const H5Reader& file, const std::string& name, const std::vector<float>& now) {
  const auto then = file.ReadValues<float>(name, name == "example/value"
                                                     ? std::vector<std::int64_t>{kExampleRows}
                                                     : std::vector<std::int64_t>{kExampleRows, -1});
  if (then.size() != now.size())
    Fail("{}: {}: expected {} values, found {}", file.path(), name, now.size(), then.size());
  for (std::size_t i = 0; i < now.size(); ++i)
    if (!(std::abs(now[i] - then[i]) <= kExampleTolerance * (1 + std::abs(then[i]))))
      Fail("{}: {}: element {}: this build computes {}, the file was made with {}", file.path(),
           name, i, now[i], then[i]);
}

}  // namespace

void WriteStructure(H5Writer& file, const PolicyStructure& s) {
  file.WriteString("structure/kind", s.kind, {"", "", "see MakePolicy"});
  WriteNumber(file, "obs_size", s.obs_size);
  WriteNumber(file, "phys_size", s.phys_size);
  WriteNumber(file, "feature_size", s.feature_size);
  WriteNumber(file, "num_categories", s.num_categories);
  WriteNumber(file, "num_actions", s.num_actions);
  WriteNumber(file, "cloud_points", s.cloud_points);
  WriteWidths(file, "cloud_widths", s.cloud_widths);
  WriteWidths(file, "extrinsics_widths", s.extrinsics_widths);
  WriteNumber(file, "z_size", s.z_size);
  WriteNumber(file, "train_encoders", s.train_encoders);
  WriteWidths(file, "hidden", s.hidden);
  file.Write("structure/phys_seen", s.phys_seen, {static_cast<std::int64_t>(s.phys_seen.size())},
             {"1", "input", "columns of e_phys that the networks see; none: all"});
  WriteNumber(file, "see_cloud", s.see_cloud);
  WriteNumber(file, "see_category", s.see_category);
  WriteNumber(file, "experts", s.experts);
  WriteNumber(file, "top_k", s.top_k);
  WriteWidths(file, "ranks", s.ranks);
  WriteNumber(file, "category_rank", s.category_rank);
  WriteWidths(file, "gate_widths", s.gate_widths);
  file.WriteString("structure/gate_input", s.gate_input, {"", "", "full, cloud or category"});
  WriteNumber(file, "gate_uniform", s.gate_uniform);
  file.WriteString("structure/precision", s.precision, {"", "", "of the training: f32 or bf16"});
}

PolicyStructure ReadStructure(const H5Reader& file) {
  PolicyStructure s;
  s.kind = file.ReadString("structure/kind");
  s.obs_size = ReadNumber(file, "obs_size");
  s.phys_size = ReadNumber(file, "phys_size");
  s.feature_size = ReadNumber(file, "feature_size");
  s.num_categories = ReadNumber(file, "num_categories");
  s.num_actions = ReadNumber(file, "num_actions");
  if (file.Has("structure/cloud_points")) s.cloud_points = ReadNumber(file, "cloud_points");
  s.cloud_widths = ReadWidths(file, "cloud_widths");
  s.extrinsics_widths = ReadWidths(file, "extrinsics_widths");
  s.z_size = ReadNumber(file, "z_size");
  s.train_encoders = ReadNumber(file, "train_encoders") != 0;
  s.hidden = ReadWidths(file, "hidden");
  s.experts = ReadNumber(file, "experts");
  if (file.Has("structure/top_k")) {  // files from before them have none of these
    s.phys_seen = ReadWidths(file, "phys_seen");
    s.see_cloud = ReadNumber(file, "see_cloud") != 0;
    s.see_category = ReadNumber(file, "see_category") != 0;
    s.top_k = ReadNumber(file, "top_k");
    s.ranks = ReadWidths(file, "ranks");
    s.category_rank = ReadNumber(file, "category_rank");
  }
  s.gate_widths = ReadWidths(file, "gate_widths");
  s.gate_input = file.ReadString("structure/gate_input");
  s.gate_uniform = ReadNumber(file, "gate_uniform") != 0;
  // Files from before there was a choice were trained in float32.
  if (file.Has("structure/precision")) s.precision = file.ReadString("structure/precision");
  return s;
}

void WriteCurriculum(H5Writer& file, const CurriculumState& s) {
  file.WriteScalar("curriculum/goal_angle", s.difficulty.goal_angle,
                   {"rad", "", "goals lie within this of the orientation; pi: anywhere"});
  file.WriteScalar("curriculum/velocity_tolerance", s.difficulty.velocity_tolerance,
                   {"1", "", "factor on the speeds a success allows"});
  file.WriteScalar("curriculum/gravity_factor", s.difficulty.gravity_factor,
                   {"1", "", "factor on gravity"});
  file.WriteScalar("curriculum/objects", s.difficulty.objects,
                   {"1", "", "objects in training so far; 0: all, from the start"});
  file.WriteScalar("curriculum/angle_next", std::uint8_t{s.angle_next},
                   {"1", "", "1 when the goal angle moves next"});
  file.WriteScalar("curriculum/samples", s.samples, {"1", "", "since the last decision"});
  file.WriteScalar("curriculum/episodes", s.episodes, {"1", "", "since the last decision"});
  file.WriteScalar("curriculum/successes", s.successes, {"1", "", "since the last decision"});
}

CurriculumState ReadCurriculum(const H5Reader& file) {
  CurriculumState s;
  s.difficulty.goal_angle = file.ReadScalar<double>("curriculum/goal_angle");
  s.difficulty.velocity_tolerance = file.ReadScalar<double>("curriculum/velocity_tolerance");
  if (file.Has("curriculum/gravity_factor"))
    s.difficulty.gravity_factor = file.ReadScalar<double>("curriculum/gravity_factor");
  if (file.Has("curriculum/objects"))
    s.difficulty.objects = file.ReadScalar<std::int32_t>("curriculum/objects");
  s.angle_next = file.ReadScalar<std::uint8_t>("curriculum/angle_next") != 0;
  s.samples = file.ReadScalar<std::int64_t>("curriculum/samples");
  s.episodes = file.ReadScalar<std::int64_t>("curriculum/episodes");
  s.successes = file.ReadScalar<std::int64_t>("curriculum/successes");
  return s;
}

void WriteWindow(H5Writer& file, const std::vector<EpisodeRecord>& window) {
  std::vector<double> values;
  for (const EpisodeRecord& r : window)
    values.insert(values.end(), {static_cast<double>(r.env), static_cast<double>(r.object),
                                 static_cast<double>(r.episode), static_cast<double>(r.length),
                                 static_cast<double>(r.successes), static_cast<double>(r.end),
                                 r.total_reward, r.mean_angle, r.mean_distance});
  file.Write("window", values, {static_cast<std::int64_t>(window.size()), kWindowColumns},
             {"1, rad, m",
              "episode, (env, object, episode, length, successes, end, total_reward, mean_angle, "
              "mean_distance)",
              "last ended episodes, oldest first"});
}

std::vector<EpisodeRecord> ReadWindow(const H5Reader& file) {
  const auto values = file.ReadValues<double>("window", {-1, kWindowColumns});
  std::vector<EpisodeRecord> window;
  for (std::size_t i = 0; i < values.size(); i += kWindowColumns) {
    const double* v = values.data() + i;
    EpisodeRecord r;
    r.env = static_cast<int>(v[0]);
    r.object = static_cast<int>(v[1]);
    r.episode = static_cast<std::uint64_t>(v[2]);
    r.length = static_cast<int>(v[3]);
    r.successes = static_cast<int>(v[4]);
    r.end = static_cast<EpisodeEnd>(static_cast<int>(v[5]));
    r.total_reward = v[6];
    r.mean_angle = v[7];
    r.mean_distance = v[8];
    window.push_back(r);
  }
  return window;
}

void WriteBest(H5Writer& file, const TrainState& state) {
  file.WriteScalar("best/progress", state.best.progress,
                   {"rad", "", "goal angle over velocity tolerance at the best state so far"});
  file.WriteScalar("best/successes", state.best.successes,
                   {"1", "", "its successes per episode; -1 before the first full window"});
  file.WriteScalar("settled", state.settled,
                   {"1", "", "episodes ended since the difficulty last changed"});
}

void ReadBest(const H5Reader& file, TrainState& state) {
  if (!file.Has("settled")) return;  // files from before it was kept
  state.best.progress = file.ReadScalar<double>("best/progress");
  state.best.successes = file.ReadScalar<double>("best/successes");
  state.settled = file.ReadScalar<std::int64_t>("settled");
}

void WriteCurve(H5Writer& file, const std::vector<CurveRow>& curve) {
  std::vector<double> values;
  for (const CurveRow& row : curve) values.insert(values.end(), row.begin(), row.end());
  file.WriteStrings("curve/column", {kCurveColumns.begin(), kCurveColumns.end()},
                    {"", "column", "names"});
  file.Write("curve/row", values,
             {static_cast<std::int64_t>(curve.size()), std::int64_t{kCurveColumns.size()}},
             {"rad, m, 1", "iteration, column", "learning curve"});
}

// Columns that the file does not know (it is older than they are) are 0.
std::vector<CurveRow> ReadCurve(const H5Reader& file) {
  const std::vector<std::string> names = file.ReadStrings("curve/column");
  const auto values =
      file.ReadValues<double>("curve/row", {-1, static_cast<std::int64_t>(names.size())});
  std::vector<CurveRow> curve(names.empty() ? 0 : values.size() / names.size(), CurveRow{});
  for (std::size_t c = 0; c < kCurveColumns.size(); ++c) {
    const auto found = std::find(names.begin(), names.end(), kCurveColumns[c]);
    if (found == names.end()) continue;
    for (std::size_t i = 0; i < curve.size(); ++i)
      curve[i][c] = values[i * names.size() + static_cast<std::size_t>(found - names.begin())];
  }
  return curve;
}

void WriteEnvironment(H5Writer& file, const std::vector<std::vector<std::uint8_t>>& ranks) {
  std::vector<std::uint8_t> all;
  std::vector<std::int64_t> end;
  for (const std::vector<std::uint8_t>& rank : ranks) {
    all.insert(all.end(), rank.begin(), rank.end());
    end.push_back(static_cast<std::int64_t>(all.size()));
  }
  file.Write("environment", all, {static_cast<std::int64_t>(all.size())},
             {"1", "byte", "state of all environments, rank after rank"});
  file.Write("environment_end", end, {static_cast<std::int64_t>(end.size())},
             {"byte", "rank", "where the ranks' parts end"});
}

std::vector<std::vector<std::uint8_t>> ReadEnvironment(const H5Reader& file) {
  const auto all = file.ReadValues<std::uint8_t>("environment", {-1});
  if (!file.Has("environment_end")) return {all};  // files from before there were ranks
  std::vector<std::vector<std::uint8_t>> ranks;
  std::int64_t begin = 0;
  for (const std::int64_t end : file.ReadValues<std::int64_t>("environment_end", {-1})) {
    if (end < begin || end > static_cast<std::int64_t>(all.size()))
      Fail("{}: environment_end: expected {} to {}, found {}", file.path(), begin, all.size(), end);
    ranks.emplace_back(all.begin() + begin, all.begin() + end);
    begin = end;
  }
  return ranks;
}

PolicyExample MakeExample(const TrainState& state, const Policy<float>& policy) {
  PolicyExample example;
  Rng rng(0, Stream::kTest, {0});
  const auto draw = [&](int count) {
    std::vector<float> values(count);
    for (float& value : values) value = static_cast<float>(rng.Normal());
    return values;
  };
  example.obs = draw(kExampleRows * state.structure.obs_size);
  example.phys = draw(kExampleRows * state.structure.phys_size);
  for (int r = 0; r < kExampleRows; ++r) example.object.push_back(r % state.table.objects());
  example.mean.resize(kExampleRows * state.structure.num_actions);
  example.value.resize(kExampleRows);
  const ShapeRows shapes(state.table, state.normalizers.feature, state.normalizers.clip,
                         state.structure.num_categories);
  Workspace<float> work;
  policy.Forward(
      state.params.data(), shapes.inputs(),
      {kExampleRows, example.obs.data(), example.phys.data(), example.object.data(), nullptr}, work,
      example.mean.data(), example.value.data());
  return example;
}

void WriteExample(H5Writer& file, const PolicyExample& example) {
  const auto columns = [](const std::vector<float>& values) {
    return static_cast<std::int64_t>(values.size()) / kExampleRows;
  };
  file.Write("example/obs", example.obs, {kExampleRows, columns(example.obs)},
             {"1", "row, component", "normalised observations"});
  file.Write("example/phys", example.phys, {kExampleRows, columns(example.phys)},
             {"1", "row, component", "normalised privileged state"});
  file.Write("example/object", example.object, {kExampleRows}, {"1", "row", "into table/*"});
  file.Write("example/mean", example.mean, {kExampleRows, columns(example.mean)},
             {"1", "row, action", "the action means they give"});
  file.Write("example/value", example.value, {kExampleRows},
             {"1", "row", "the normalised values they give"});
}

void CheckExample(const H5Reader& file, const PolicyExample& now) {
  CheckClose(file, "example/mean", now.mean);
  CheckClose(file, "example/value", now.value);
}

}  // namespace dexremoe
