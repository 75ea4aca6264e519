// State of a ReorientBatch. Internal to lib/task.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "task/reorient.h"

namespace dexremoe::internal {

// Row = environment; N environments, J joints.
// | name              | shape  | unit    | meaning                                              |
// | object            | [N]    |         | index of the object                                  |
// | grasp             | [N]    |         | start grasp of the episode                           |
// | episode           | [N]    |         | number that addresses the random streams             |
// | live              | [N]    |         | 0 after an end without automatic reset               |
// | length, successes | [N]    | 1       | of the episode so far                                |
// | goals             | [N]    | 1       | goals drawn so far                                   |
// | held              | [N]    | 1       | control steps in a row that met the goal             |
// | waited            | [N]    | 1       | control steps since the last success or the start    |
// | total_reward ...  | [N]    |         | sums over the episode's steps                        |
// | average           | [N,J]  | 1       | moving average of actions                            |
// | target            | [N,J]  | rad     | servo targets                                        |
// | q, qd             | [N,J]  | rad(/s) | joints at the last control step; qd its difference   |
// | position          | [N,3]  | m, W    | object at the last control step                      |
// | rotation          | [N,4]  | w x y z | object at the last control step                      |
// | goal              | [N,4]  | w x y z | q_WG                                                 |
// | angle, distance   | [N]    | rad, m  | to the goal, from the grasp centre                   |
// | obs, phys         | [N,..] |         | observations; obs rows are the history themselves    |
// | gravity           | [N]    | m/s^2   | of the episode along z, before randomisation         |
// | random            | [N,P]  |         | values drawn for the episode (kRandomParameters)     |
// | last_action       | [N,J]  | 1       | of the decision before, as executed                  |
// | force             | [N,3]  | N, W    | random force on the object                           |
struct TaskState {
  std::vector<std::int32_t> object, grasp, length, successes, goals, held, waited;
  std::vector<std::uint64_t> episode;
  std::vector<std::uint8_t> live;
  std::vector<double> total_reward, total_angle, total_distance;
  std::vector<double> average, target, q, qd, position, rotation;
  std::vector<std::array<double, 4>> goal;
  std::vector<double> angle, distance, gravity;
  std::vector<float> obs, phys;
  std::vector<double> random, last_action, force;  // with randomisation alone

  void Resize(int num_envs, int joints, int phys_size);
  void ResizeRandom(int num_envs, int joints);
  void Save(ByteWriter& out) const;
  // Throws Error when the image does not fit the sizes set by Resize.
  void Restore(ByteReader& in);
};

void SaveOptions(const TaskOptions& options, ByteWriter& out);
void RestoreOptions(ByteReader& in, TaskOptions& options);

void SaveRecords(const std::vector<EpisodeRecord>& records, ByteWriter& out);
std::vector<EpisodeRecord> RestoreRecords(ByteReader& in);

}  // namespace dexremoe::internal
