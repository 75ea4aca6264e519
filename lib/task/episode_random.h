// The randomised episode: values drawn from the ranges, and what follows from them. Internal to
// lib/task.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "geometry/pose.h"
#include "task/episode.h"
#include "task/randomization.h"

namespace dexremoe::internal {

using RandomValues = std::array<double, kNumRandom>;

// The bound that the episode stands at, or -1.
int DrawBound(const RandomOptions& options, std::uint64_t seed, const EpisodeKey& key);
RandomValues DrawRandomValues(const RandomOptions& options, std::uint64_t seed,
                              const EpisodeKey& key);

// Constant during an episode.
struct EpisodeRandom {
  RandomValues value;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();        // added, m/s^2, W
  Eigen::Vector3d position_bias = Eigen::Vector3d::Zero();  // m, W
  Eigen::Vector3d rotation_bias = Eigen::Vector3d::Zero();  // rotation vector, rad, W
  std::vector<double> lower, upper;                         // [J] added to the targets' limits, rad
  bool delayed = false;                                     // actions come a control step late
};
EpisodeRandom MakeEpisodeRandom(const RandomValues& values, std::uint64_t seed,
                                const EpisodeKey& key, int joints);
// Size, mass, friction, servo gains and gravity of the episode.
void Randomize(const EpisodeRandom& random, EnvPhysics& physics);

// What the policy sees at decision `t`: joints [J] in place, and the object's pose.
Pose SeenPose(const EpisodeRandom& random, const Pose& X_WO, Rng& rng);
void SeeJoints(const EpisodeRandom& random, Rng& rng, std::vector<double>& q);
// The action [J] that is executed.
void DisturbAction(const EpisodeRandom& random, Rng& rng, std::vector<double>& action);
// The force on the object during the next control step of `seconds`: it decays, and is drawn anew
// now and then (OpenAI et al. 2018: 1 m/s^2 deviation, 0.99 per 80 ms).
Eigen::Vector3d NextForce(const EpisodeRandom& random, double mass, double seconds,
                          const Eigen::Vector3d& force, Rng& rng);

}  // namespace dexremoe::internal
