// Recorded episodes: what the renderer needs to show one, and what a reader needs to study one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/h5.h"

namespace dexremoe {

inline constexpr H5Format kTraceFormat{"dexremoe.trace", 1};

// One episode, row = decision (TaskOptions::action_repeat control steps). Row t holds the state
// before action t, the action, and whether it brought a success (the goal of row t + 1 is then a new one).
struct EpisodeTrace {
  std::string object;  // name in objects.csv
  std::string category;
  std::uint64_t episode = 0;  // number that addressed the random streams
  double scale = 1;           // size factor on the object's files
  std::string end;            // "fall", "jam" or "time" (OutcomeName)
  int successes = 0;
  std::vector<double> joint_position;   // [T, J] rad
  std::vector<double> object_position;  // [T, 3] m in W
  std::vector<double> object_rotation;  // [T, 4] w x y z, R_WO
  std::vector<double> goal_rotation;    // [T, 4] w x y z, R_WG
  std::vector<double> angle;            // [T] rad, rotation distance to the goal
  std::vector<std::uint8_t> success;    // [T]
  std::vector<float> action;            // [T, J]
  std::vector<float> gate;              // [T, E]; empty for a policy without a gate

  int length() const { return static_cast<int>(angle.size()); }
};

struct TraceFile {
  std::string policy;                     // file name
  double control_rate = 60;               // Hz, rows per second
  double tolerance = 0;                   // rad
  std::vector<std::string> joint_names;   // [J]
  std::vector<std::string> expert_names;  // [E]; empty without a gate
  std::vector<EpisodeTrace> episodes;
};

// Throws Error when the file cannot be written.
void WriteTrace(const std::string& path, const TraceFile& trace, const Provenance& provenance);
// Throws Error naming file and dataset when something is missing or extents disagree.
TraceFile ReadTrace(const std::string& path);

}  // namespace dexremoe
