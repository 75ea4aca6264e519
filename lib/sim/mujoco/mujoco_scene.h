// MuJoCo models of a run: one of each object, and from it one of each set of physical parameters.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "sim/batch_sim.h"

namespace dexremoe {

struct MujocoDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using MujocoModel = std::unique_ptr<mjModel, MujocoDeleter>;
using MujocoData = std::unique_ptr<mjData, MujocoDeleter>;

class MujocoScene {
 public:
  MujocoScene(const SimOptions& options, const HandModel& hand, std::vector<SimObject> objects);

  const SimOptions& options() const { return options_; }
  const HandModel& hand() const { return hand_; }
  const std::vector<SimObject>& objects() const { return objects_; }
  double time_step() const { return 1.0 / (options_.control_rate * options_.substeps); }

  // Where hand and object stand in MuJoCo's arrays; the same for all objects, since the object is
  // the last body.
  int DofOf(int joint) const { return joint_dof_[joint]; }  // also its place in qpos
  int object_dof() const { return hand_.num_joints(); }     // 6 of qvel, 7 of qpos
  int object_body() const { return static_cast<int>(hand_.links.size()); }
  int num_dofs() const { return hand_.num_joints() + 6; }
  // Index into hand.colliders, or -1 for a part of the object.
  int ColliderOf(int geom) const {
    return geom < static_cast<int>(collider_.size()) ? collider_[geom] : -1;
  }

  // The model of `object` with mass, centre of mass, both frictions and scale of `physics` (gravity
  // and servo gains are not part of it). Environments with equal parameters share one. Throws Error
  // when the mass or the scale is not positive or a friction negative. Not thread-safe.
  std::shared_ptr<const mjModel> ModelFor(int object, const EnvPhysics& physics);

 private:
  using Key = std::array<double, 8>;
  MujocoModel Compile(const SimObject& object) const;
  MujocoModel Variant(int object, const EnvPhysics& physics) const;

  SimOptions options_;
  HandModel hand_;
  std::vector<SimObject> objects_;
  std::vector<MujocoModel> prototypes_;  // per object: mass 1, scale 1
  std::vector<int> joint_dof_, collider_;
  std::map<Key, std::weak_ptr<const mjModel>> variants_;
  std::size_t prune_at_ = 64;  // size at which entries of models no longer in use are dropped
};

}  // namespace dexremoe
