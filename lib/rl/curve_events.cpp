#include "rl/curve_events.h"

#include <chrono>
#include <map>
#include <string_view>

namespace dexremoe {
namespace {

// Names that users of TensorBoard know; the other columns keep their own.
const std::map<std::string_view, const char*> kTags = {
    {"successes_per_episode", "success/per_episode"},
    {"successes_per_600", "success/per_600"},
    {"mean_distance", "dp"},
    {"mean_angle", "angle"},
    {"learning_rate", "lr"},
    {"policy_loss", "loss/policy"},
    {"value_loss", "loss/value"},
    {"goal_angle", "curriculum/goal_angle"},
    {"velocity_tolerance", "curriculum/velocity"},
    {"gravity_factor", "curriculum/gravity"},
    {"objects", "curriculum/objects"},
    {"routing_entropy", "routing/entropy"},
    {"expert_load_least", "routing/load_least"},
    {"expert_load_most", "routing/load_most"},
    {"auxiliary_loss", "loss/auxiliary"}};

double Now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

CurveEvents::CurveEvents(const std::string& folder, std::int64_t samples) {
  if (!folder.empty()) file_ = std::make_unique<EventFile>(folder, samples);
}

void CurveEvents::Add(const CurveRow& row, const IterationTime& time, double samples,
                      const std::vector<std::pair<std::string, double>>& more) {
  if (file_ == nullptr) return;
  std::vector<std::pair<std::string, double>> scalars = {
      {"fps/total", samples / (time.rollout + time.update)},
      {"fps/rollout", samples / time.rollout},
      {"fps/update", samples / time.update}};
  std::int64_t step = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::string_view column = kCurveColumns[i];
    const auto tag = kTags.find(column);
    if (column == "samples")
      step = static_cast<std::int64_t>(row[i]);
    else if (column != "iteration")
      scalars.emplace_back(tag != kTags.end() ? tag->second : column, row[i]);
  }
  scalars.insert(scalars.end(), more.begin(), more.end());
  file_->Add(step, Now(), scalars);
}

}  // namespace dexremoe
