// Constants of a run, as the kernels read them: the hand's chains and cores, the objects' fields.
//
// Every link frame is turned so that its joint turns about +z; all numbers of a link are in that
// frame L. Only plain floats: the same value holds for all lanes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/batch_sim.h"
#include "sim/lanes/big_array.h"
#include "sim/lanes/lane_block.h"

namespace dexremoe {

struct LaneLink {
  float R_PL[9];       // at joint angle 0, by columns
  float p_PL[3];       // m
  float mass;          // kg
  float com[3];        // m
  float inertia[6];    // about com: xx yy zz xy xz yz; kg m^2
  float lower, upper;  // rad
  float torque_limit;  // N m
  float speed_limit;   // rad/s
};

// A serial chain: links and joints first .. first + size - 1 in the engine's order, chain after
// chain.
struct LaneChain {
  int first = 0, size = 0;
  float tip_center[3] = {0, 0, 0};  // of a ball around the tip's cores, in the last link's L; m
  float tip_radius = 0;             // m
};

// A rounded core (see hand_cores.h). `extents` directions are not zero.
struct LaneCore {
  int chain;        // -1: the base
  int link;         // index in the chain; -1: the base
  int extents;      // 0 sphere, 1 capsule, 2 plate, 3 box
  float center[3];  // in L; m
  float axes[9];    // by columns, longest first; in L
  float half[3];    // m
  float radius;     // m
  bool tip;
};

// Two cores of the hand that may touch; a is a capsule or sphere of a fingertip.
struct LaneCorePair {
  int a, b;
};

// An object as SetObject needs it.
struct LaneObject {
  bool turned = false;                                       // q_OB is not the identity
  Eigen::Quaterniond q_OB = Eigen::Quaterniond::Identity();  // B: principal axes
  Eigen::Vector3d unit_inertia;                              // principal moments / mass; m^2
  double radius = 0;                                         // bounding sphere about O; m
  Box3 box;                                                  // of the parts, in B; m
  std::int32_t first_node = 0;                               // of its field in LanesModel::cells
  Eigen::Vector3d origin, spacing;                           // of its field, in B at scale 1; m
  double quantum = 0;                                        // m per count
};

struct LanesModel {
  BlockLayout layout;
  std::vector<LaneChain> chains;
  std::vector<LaneLink> links;      // [J]
  std::vector<int> joint_of;        // [J]: HandModel joint of each link here
  std::vector<LaneCore> cores;      // by chain, the base's last
  std::vector<LaneCorePair> pairs;  // by the chains of a and b
  std::vector<LaneObject> objects;
  BigArray<std::int16_t> nodes;  // fields of all objects
  double kp = 0, kd = 0;         // N m/rad, N m s/rad
  float armature = 0;            // kg m^2
  float substep = 0;             // s: contacts are found once in it
  int substeps = 0, inner_steps = 0, iterations = 0;
};

// Throws Error naming the hand or object and what it has too much of.
LanesModel MakeLanesModel(const SimOptions& options, const HandModel& hand,
                          const std::vector<SimObject>& objects, ThreadPool& pool);

}  // namespace dexremoe
