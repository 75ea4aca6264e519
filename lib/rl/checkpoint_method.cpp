// What checkpoints hold of methods: their description, and ADR's state.
#include "base/error.h"
#include "rl/checkpoint_fields.h"

namespace dexremoe {

void WriteCard(H5Writer& file, const MethodCard& card) {
  file.WriteString("method/inputs", card.inputs, {"", "", "what the networks see"});
  file.WriteString("method/network", card.network, {"", "", "and what of it is trained"});
  file.WriteString("method/losses", card.losses, {"", "", "beside PPO's"});
  file.WriteString("method/curriculum", card.curriculum, {"", "", "and randomisation"});
}

MethodCard ReadCard(const H5Reader& file) {
  if (!file.Has("method/inputs")) return {};  // files from before it was kept
  return {file.ReadString("method/inputs"), file.ReadString("method/network"),
          file.ReadString("method/losses"), file.ReadString("method/curriculum")};
}

void WriteAdr(H5Writer& file, const AdrState& state) {
  if (state.empty()) return;
  std::vector<double> queue, history;
  std::vector<std::int64_t> queue_end;
  for (const std::vector<double>& q : state.queue) {
    queue.insert(queue.end(), q.begin(), q.end());
    queue_end.push_back(static_cast<std::int64_t>(queue.size()));
  }
  for (const std::vector<double>& row : state.history)
    history.insert(history.end(), row.begin(), row.end());
  const std::vector<std::string> columns = AdrColumns();
  const std::int64_t width = static_cast<std::int64_t>(columns.size());
  file.Write("adr/low", state.low, {kNumRandom}, {"mixed", "parameter", "lower bounds"});
  file.Write("adr/high", state.high, {kNumRandom}, {"mixed", "parameter", "upper bounds"});
  file.Write("adr/queue", queue, {static_cast<std::int64_t>(queue.size())},
             {"1", "episode", "successes of boundary episodes, bound after bound"});
  file.Write("adr/queue_end", queue_end, {2 * kNumRandom},
             {"1", "bound", "where the bounds' parts end"});
  file.WriteStrings("adr/column", columns, {"", "column", "names"});
  file.Write("adr/history", history, {static_cast<std::int64_t>(state.history.size()), width},
             {"mixed", "change, column", "ranges over time"});
}

AdrState ReadAdr(const H5Reader& file) {
  AdrState state;
  if (!file.Has("adr/low")) return state;
  const std::int64_t width = static_cast<std::int64_t>(AdrColumns().size());
  state.low = file.ReadValues<double>("adr/low", {kNumRandom});
  state.high = file.ReadValues<double>("adr/high", {kNumRandom});
  const auto queue = file.ReadValues<double>("adr/queue", {-1});
  std::int64_t begin = 0;
  for (const std::int64_t end : file.ReadValues<std::int64_t>("adr/queue_end", {2 * kNumRandom})) {
    if (end < begin || end > static_cast<std::int64_t>(queue.size()))
      Fail("{}: adr/queue_end: expected {} to {}, found {}", file.path(), begin, queue.size(), end);
    state.queue.emplace_back(queue.begin() + begin, queue.begin() + end);
    begin = end;
  }
  const auto history = file.ReadValues<double>("adr/history", {-1, width});
  for (std::size_t i = 0; i < history.size(); i += static_cast<std::size_t>(width))
    state.history.emplace_back(history.begin() + static_cast<std::int64_t>(i),
                               history.begin() + static_cast<std::int64_t>(i) + width);
  return state;
}

}  // namespace dexremoe
