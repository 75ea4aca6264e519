// A small task: two joints, objects with a few grasps, a scripted simulator.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "fake_sim.h"
#include "task/reorient.h"
#include "task/rotation.h"

namespace dexremoe {

inline HandModel TwoJointHand() {
  HandModel hand;
  hand.links.resize(3);
  for (int j = 0; j < 2; ++j) {
    Joint joint;
    joint.child = j + 1;
    joint.lower = -1;
    joint.upper = j == 0 ? 1 : 3;
    hand.joints.push_back(joint);
    hand.chains.push_back({j});
  }
  hand.tip_frames.resize(2);
  return hand;
}

inline TaskObject MakeTaskObject(const std::string& name, int grasps) {
  TaskObject object;
  object.name = name;
  Rng rng(5, Stream::kTest, {name.size()});
  for (int g = 0; g < grasps; ++g) {
    const auto u = rng.UnitQuaternion();
    Grasp grasp;
    grasp.q = {0.01 * g, 0.5};
    grasp.target = {0.01 * g + 0.1, 0.6};
    grasp.X_WO = {Eigen::Quaterniond(u[0], u[1], u[2], u[3]),
                  Eigen::Vector3d(0.001 * g, 0.06, 0.1)};
    object.grasps.push_back(grasp);
  }
  return object;
}

// A batch on a FakeSim that the test can reach.
struct FakeTask {
  explicit FakeTask(const TaskOptions& options, int num_envs = 4, std::uint64_t seed = 1,
                    std::vector<std::string> names = {"duck", "car"}) {
    auto owned = std::make_unique<FakeSim>(num_envs, 2, 2);
    sim = owned.get();
    std::vector<TaskObject> objects;
    for (const std::string& name : names) objects.push_back(MakeTaskObject(name, 20));
    batch = std::make_unique<ReorientBatch>(options, SimOptions(), TwoJointHand(), objects,
                                            std::move(owned), seed, pool);
  }
  const StepResult& Step(float a = 0, float b = 0) {
    std::vector<float> actions;
    for (int env = 0; env < batch->num_envs(); ++env) actions.insert(actions.end(), {a, b});
    return batch->Step(actions);
  }
  ThreadPool pool{2};
  FakeSim* sim = nullptr;
  std::unique_ptr<ReorientBatch> batch;
};

inline Eigen::Quaterniond GoalOf(const ReorientBatch& batch, int env) {
  const auto& g = batch.goal()[env];
  return {g[0], g[1], g[2], g[3]};
}

}  // namespace dexremoe
