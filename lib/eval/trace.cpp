#include "eval/trace.h"

#include "base/check.h"
#include "base/error.h"

namespace dexremoe {
namespace {

// Appends the same member of every episode into one array.
template <typename T>
std::vector<T> Join(const std::vector<EpisodeTrace>& episodes, std::vector<T> EpisodeTrace::*part) {
  std::vector<T> all;
  for (const EpisodeTrace& e : episodes) all.insert(all.end(), (e.*part).begin(), (e.*part).end());
  return all;
}

template <typename T>
std::vector<T> Gather(const std::vector<EpisodeTrace>& episodes, T EpisodeTrace::*part) {
  std::vector<T> all;
  for (const EpisodeTrace& e : episodes) all.push_back(e.*part);
  return all;
}

// The slice of a joined array that belongs to steps begin .. end-1.
template <typename T>
std::vector<T> Slice(const std::vector<T>& all, std::int64_t width, int begin, int end) {
  return {all.begin() + begin * width, all.begin() + end * width};
}

void WriteSteps(H5Writer& file, const TraceFile& trace, std::int64_t steps) {
  const auto& episodes = trace.episodes;
  const auto joints = static_cast<std::int64_t>(trace.joint_names.size());
  const auto experts = static_cast<std::int64_t>(trace.expert_names.size());
  file.Write("joint_position", Join(episodes, &EpisodeTrace::joint_position), {steps, joints},
             {"rad", "step, joint", "joint angles before the action"});
  file.Write("object_position", Join(episodes, &EpisodeTrace::object_position), {steps, 3},
             {"m", "step, axis", "object centre of mass in W"});
  file.Write("object_rotation", Join(episodes, &EpisodeTrace::object_rotation), {steps, 4},
             {"1", "step, w x y z", "object orientation R_WO"});
  file.Write("goal_rotation", Join(episodes, &EpisodeTrace::goal_rotation), {steps, 4},
             {"1", "step, w x y z", "goal orientation R_WG"});
  file.Write("angle", Join(episodes, &EpisodeTrace::angle), {steps},
             {"rad", "step", "rotation distance to the goal"});
  file.Write("success", Join(episodes, &EpisodeTrace::success), {steps},
             {"1", "step", "1 when the step after this row reached the goal"});
  file.Write("action", Join(episodes, &EpisodeTrace::action), {steps, joints},
             {"1", "step, joint", "action taken"});
  if (experts > 0)
    file.Write("gate", Join(episodes, &EpisodeTrace::gate), {steps, experts},
               {"1", "step, expert", "gate weights"});
}

void ReadEpisodeSteps(const H5Reader& file, TraceFile& trace) {
  const auto offset = file.ReadValues<std::int32_t>(
      "step_offset", {static_cast<std::int64_t>(trace.episodes.size()) + 1});
  const std::int64_t steps = offset.back();
  for (std::size_t i = 0; i + 1 < offset.size(); ++i)
    if (offset[0] != 0 || offset[i] > offset[i + 1])
      Fail("{}: dataset 'step_offset': expected growing offsets from 0", file.path());
  const auto joints = static_cast<std::int64_t>(trace.joint_names.size());
  const auto experts = static_cast<std::int64_t>(trace.expert_names.size());
  const auto q = file.ReadValues<double>("joint_position", {steps, joints});
  const auto p = file.ReadValues<double>("object_position", {steps, 3});
  const auto r = file.ReadValues<double>("object_rotation", {steps, 4});
  const auto goal = file.ReadValues<double>("goal_rotation", {steps, 4});
  const auto angle = file.ReadValues<double>("angle", {steps});
  const auto success = file.ReadValues<std::uint8_t>("success", {steps});
  const auto action = file.ReadValues<float>("action", {steps, joints});
  std::vector<float> gate;
  if (experts > 0) gate = file.ReadValues<float>("gate", {steps, experts});
  for (std::size_t i = 0; i < trace.episodes.size(); ++i) {
    EpisodeTrace& e = trace.episodes[i];
    const int begin = offset[i], end = offset[i + 1];
    e.joint_position = Slice(q, joints, begin, end);
    e.object_position = Slice(p, 3, begin, end);
    e.object_rotation = Slice(r, 4, begin, end);
    e.goal_rotation = Slice(goal, 4, begin, end);
    e.angle = Slice(angle, 1, begin, end);
    e.success = Slice(success, 1, begin, end);
    e.action = Slice(action, joints, begin, end);
    e.gate = Slice(gate, experts, begin, end);
  }
}

}  // namespace

void WriteTrace(const std::string& path, const TraceFile& trace, const Provenance& provenance) {
  H5Writer file(path, kTraceFormat, provenance);
  const auto count = static_cast<std::int64_t>(trace.episodes.size());
  std::vector<std::int32_t> offset = {0};
  for (const EpisodeTrace& e : trace.episodes) offset.push_back(offset.back() + e.length());
  file.WriteString("policy", trace.policy, {"", "", "policy file"});
  file.WriteScalar("control_rate", trace.control_rate, {"Hz", "", "rows per second"});
  file.WriteScalar("tolerance", trace.tolerance, {"rad", "", "success tolerance"});
  file.WriteStrings("joint_names", trace.joint_names, {"", "joint", "joints of the hand"});
  file.WriteStrings("expert_names", trace.expert_names, {"", "expert", "experts behind the gate"});
  file.Write("step_offset", offset, {count + 1},
             {"1", "episode", "first row of each episode, then the number of rows"});
  file.WriteStrings("object", Gather(trace.episodes, &EpisodeTrace::object),
                    {"", "episode", "name of the object"});
  file.WriteStrings("category", Gather(trace.episodes, &EpisodeTrace::category),
                    {"", "episode", "category of the object"});
  file.WriteStrings("end", Gather(trace.episodes, &EpisodeTrace::end),
                    {"", "episode", "how it ended: fall, jam or time"});
  file.Write("number", Gather(trace.episodes, &EpisodeTrace::episode), {count},
             {"1", "episode", "episode number; addresses the random streams"});
  file.Write("scale", Gather(trace.episodes, &EpisodeTrace::scale), {count},
             {"1", "episode", "size factor on the object's files"});
  const std::vector<int> successes = Gather(trace.episodes, &EpisodeTrace::successes);
  file.Write("successes", std::vector<std::int32_t>(successes.begin(), successes.end()), {count},
             {"1", "episode", "goals reached"});
  WriteSteps(file, trace, offset.back());
  file.Commit();
}

TraceFile ReadTrace(const std::string& path) {
  const H5Reader file(path, kTraceFormat);
  TraceFile trace;
  trace.policy = file.ReadString("policy");
  trace.control_rate = file.ReadScalar<double>("control_rate");
  trace.tolerance = file.ReadScalar<double>("tolerance");
  trace.joint_names = file.ReadStrings("joint_names");
  trace.expert_names = file.ReadStrings("expert_names");
  const std::vector<std::string> object = file.ReadStrings("object");
  const auto count = static_cast<std::int64_t>(object.size());
  const std::vector<std::string> category = file.ReadStrings("category");
  const std::vector<std::string> end = file.ReadStrings("end");
  if (category.size() != object.size() || end.size() != object.size())
    Fail("{}: datasets 'object', 'category', 'end': expected equal extents, found {}, {}, {}", path,
         object.size(), category.size(), end.size());
  const auto number = file.ReadValues<std::uint64_t>("number", {count});
  const auto scale = file.ReadValues<double>("scale", {count});
  const auto successes = file.ReadValues<std::int32_t>("successes", {count});
  trace.episodes.resize(object.size());
  for (std::size_t i = 0; i < object.size(); ++i) {
    EpisodeTrace& e = trace.episodes[i];
    e.object = object[i];
    e.category = category[i];
    e.end = end[i];
    e.episode = number[i];
    e.scale = scale[i];
    e.successes = successes[i];
  }
  ReadEpisodeSteps(file, trace);
  return trace;
}

}  // namespace dexremoe
