// The numbers of all environments of the lanes engine, by slot: block and lane.
#pragma once

#include <span>
#include <vector>

#include "sim/batch_sim.h"
#include "sim/lanes/big_array.h"
#include "sim/lanes/lanes_model.h"

namespace dexremoe {

// Puts states and parameters in the units and frames of BatchSim into blocks (see lane_block.h)
// and back. Slot s is lane s % kBlockLanes of block s / kBlockLanes. `model` must outlive it.
class LaneStore {
 public:
  // Every slot holds object 0 far below the hand, the lanes beyond `num_envs` for good.
  LaneStore(const LanesModel& model, int num_envs);

  int blocks() const { return blocks_; }
  float* Block(int block);  // [layout.rows][kBlockLanes]
  int object(int slot) const { return object_[slot]; }

  // Throws Error when the mass is not positive.
  void PutObject(int slot, int object, const EnvPhysics& physics);
  void PutState(int slot, const EnvState& state);
  void PutHeld(int slot, bool held);
  void PutPush(int slot, const Eigen::Vector3d& force);
  void PutTargets(int slot, const double* targets);  // [J], in the hand's order
  // Copies the state of `slot` into row `env` of the arrays.
  void Read(int slot, int env, SimState& state) const;

  // Asks the processor to have a block in its cache soon.
  void Prefetch(int block) const;
  // Whether joints and objects of all lanes of a block have finite states.
  bool AllFinite(int block) const;

  // Everything of a slot, bit for bit.
  std::vector<float> Numbers(int slot) const;
  void PutNumbers(int slot, int object, std::span<const float> numbers);
  // Slot s takes what slot order[s] held; order is a permutation of the first slots.
  void Reorder(std::span<const int> order);

 private:
  std::size_t Index(int slot, int row) const;
  float& At(int slot, int row) { return rows_[Index(slot, row)]; }
  float At(int slot, int row) const { return rows_[Index(slot, row)]; }
  void PutVector(int slot, int row, const Eigen::Vector3d& v);
  Eigen::Vector3d GetVector(int slot, int row) const;
  Eigen::Quaterniond Rotation_WB(int slot) const;
  void ForgetContacts(int slot);

  const LanesModel& model_;
  int blocks_;
  BigArray<float> rows_;     // [blocks][layout.rows][kBlockLanes]
  std::vector<int> object_;  // by slot
};

}  // namespace dexremoe
