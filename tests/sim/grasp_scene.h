// Cubes between the fingers of the GX11: the fingers close around a held object, then let it hang.
#pragma once

#include <algorithm>
#include <vector>

#include "base/random.h"
#include "scenes.h"

namespace dexremoe::scenes {

inline const Eigen::Vector3d kGraspCenter(0.0, 0.056, 0.122);  // 11 cm off the palm; m, W

struct GraspScene {
  GraspScene(const SimOptions& options, int num_envs, int workers,
             const EnvPhysics& physics_of_all = {}, std::uint64_t seed = 7)
      : hand(LoadHand(HandOptions())),
        physics(physics_of_all),
        rig(options, hand, {Cube()}, num_envs, workers),
        targets(num_envs * hand.num_joints()),
        squeeze(num_envs) {
    for (int env = 0; env < num_envs; ++env) Start(env, env, seed);
  }

  // Fingers open around a held cube of random orientation; `index` addresses the random numbers.
  void Start(int env, int index, std::uint64_t seed) {
    static constexpr double kOpen[] = {1.85, -.15, -.1, 1.45, 0, -.35, .1, 1.45, 0, -.35, .1};
    Rng rng(seed, Stream::kTest, {static_cast<std::uint64_t>(index)});
    const int joints = hand.num_joints();
    EnvState state = StateAt(joints, kGraspCenter);
    for (int j = 0; j < joints; ++j) {
      double q = kOpen[j] + rng.Uniform(-0.12, 0.12);
      if (j == 0) q = rng.Uniform(1.6, 2.05);
      if (j == 4 || j == 8) q = rng.Uniform(-0.3, 0.3);  // abduction
      state.q[j] = std::clamp(q, hand.joints[j].lower, hand.joints[j].upper);
      targets[env * joints + j] = state.q[j];
    }
    squeeze[env] = rng.Uniform(0.08, 0.2);
    const auto q = rng.UnitQuaternion();
    state.X_WO.q = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    rig->SetObject(env, 0, physics);
    rig->SetState(env, state);
    rig->SetHeld(env, true);
  }

  // Bends the flexion joints; a finger that touches keeps its targets `squeeze` ahead.
  void Close(int steps) {
    static constexpr int kFlexion[] = {1, 2, 5, 6, 9, 10}, kFinger[] = {0, 0, 1, 1, 2, 2};
    const int joints = hand.num_joints(), fingers = static_cast<int>(hand.chains.size());
    for (int step = 0; step < steps; ++step) {
      const SimState& state = rig->state();
      for (int env = 0; env < rig->num_envs(); ++env)
        for (int k = 0; k < 6; ++k) {
          const int j = kFlexion[k];
          const bool touches = state.tip_contact[env * fingers + kFinger[k]] != 0;
          const double ahead = touches ? squeeze[env] : 0.3;
          double& target = targets[env * joints + j];
          target = std::min({target + (k % 2 ? 0.03 : 0.024),
                             state.joint_position[env * joints + j] + ahead, hand.joints[j].upper});
        }
      rig->Step(targets);
    }
  }

  void Release() {
    for (int env = 0; env < rig->num_envs(); ++env) rig->SetHeld(env, false);
  }

  bool Holds(int env) { return (rig->GetState(env).X_WO.p - kGraspCenter).norm() < 0.03; }

  // Random joint targets around the present ones, at most 0.3 rad ahead of the joints.
  void StepRandomly(int step) {
    const int joints = hand.num_joints();
    for (int env = 0; env < rig->num_envs(); ++env) {
      Rng rng(9, Stream::kTest,
              {static_cast<std::uint64_t>(env), static_cast<std::uint64_t>(step)});
      for (int j = 0; j < joints; ++j) {
        const double q = rig->state().joint_position[env * joints + j];
        double& target = targets[env * joints + j];
        target = std::clamp(target + rng.Uniform(-0.1, 0.1), q - 0.3, q + 0.3);
      }
    }
    rig->Step(targets);
  }

  HandModel hand;
  EnvPhysics physics;  // of what Start places
  Rig rig;
  std::vector<double> targets;  // [N,J] rad
  std::vector<double> squeeze;  // [N] rad
};

}  // namespace dexremoe::scenes
