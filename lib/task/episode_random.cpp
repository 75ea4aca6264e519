#include "task/episode_random.h"

#include <algorithm>
#include <cmath>

namespace dexremoe::internal {
namespace {

// Parts of the stream of an episode.
enum Part : std::uint64_t { kBoundPart, kValuePart, kDerivedPart };

Rng StreamOf(std::uint64_t seed, const EpisodeKey& key, Part part) {
  return Rng(seed, Stream::kRandomize, {key.object, key.episode, part});
}

Eigen::Vector3d NormalVector(Rng& rng, double deviation) {
  const double x = rng.Normal(), y = rng.Normal(), z = rng.Normal();
  return deviation * Eigen::Vector3d(x, y, z);
}

Eigen::Quaterniond Turn(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation_vector / angle));
}

}  // namespace

int DrawBound(const RandomOptions& options, std::uint64_t seed, const EpisodeKey& key) {
  if (options.boundary_share == 0) return -1;
  Rng rng = StreamOf(seed, key, kBoundPart);
  if (rng.Uniform() >= options.boundary_share) return -1;
  std::vector<int> moving;
  for (int bound = 0; bound < 2 * kNumRandom; ++bound)
    if (BoundMoves(bound)) moving.push_back(bound);
  return moving[rng.Index(moving.size())];
}

RandomValues DrawRandomValues(const RandomOptions& options, std::uint64_t seed,
                              const EpisodeKey& key) {
  Rng rng = StreamOf(seed, key, kValuePart);
  RandomValues values;
  for (int i = 0; i < kNumRandom; ++i) {
    const double low = options.range[i][0], high = options.range[i][1], u = rng.Uniform();
    values[i] = kRandomParameters[i].spread == Distribution::kLogUniform
                    ? low * std::pow(high / low, u)
                    : low + (high - low) * u;
  }
  const int bound = DrawBound(options, seed, key);
  if (bound >= 0) values[bound / 2] = options.range[bound / 2][bound % 2];
  return values;
}

EpisodeRandom MakeEpisodeRandom(const RandomValues& values, std::uint64_t seed,
                                const EpisodeKey& key, int joints) {
  Rng rng = StreamOf(seed, key, kDerivedPart);
  EpisodeRandom random;
  random.value = values;
  random.gravity = NormalVector(rng, values[kGravity]);
  random.position_bias = NormalVector(rng, values[kPositionBias]);
  random.rotation_bias = NormalVector(rng, values[kRotationBias]);
  random.delayed = rng.Uniform() < values[kActionDelay];
  for (int j = 0; j < joints; ++j) {
    random.lower.push_back(values[kJointLimit] * rng.Normal());
    random.upper.push_back(values[kJointLimit] * rng.Normal());
  }
  return random;
}

void Randomize(const EpisodeRandom& random, EnvPhysics& physics) {
  physics.scale *= random.value[kSize];
  physics.mass *= random.value[kMass];
  physics.friction *= random.value[kFriction];
  physics.kd_factor = random.value[kDamping];
  physics.kp_factor = random.value[kStiffness];
  physics.gravity += random.gravity;
}

Pose SeenPose(const EpisodeRandom& random, const Pose& X_WO, Rng& rng) {
  const Eigen::Vector3d p = random.position_bias + NormalVector(rng, random.value[kPositionNoise]);
  const Eigen::Vector3d turn =
      random.rotation_bias + NormalVector(rng, random.value[kRotationNoise]);
  return {(Turn(turn) * X_WO.q).normalized(), X_WO.p + p};
}

void SeeJoints(const EpisodeRandom& random, Rng& rng, std::vector<double>& q) {
  for (double& angle : q) angle += random.value[kJointNoise] * rng.Normal();
}

void DisturbAction(const EpisodeRandom& random, Rng& rng, std::vector<double>& action) {
  for (double& a : action) {
    const double gain = 1 + random.value[kActionGain] * rng.Normal();
    a = std::clamp(gain * a + random.value[kActionNoise] * rng.Normal(), -1.0, 1.0);
  }
}

Eigen::Vector3d NextForce(const EpisodeRandom& random, double mass, double seconds,
                          const Eigen::Vector3d& force, Rng& rng) {
  constexpr double kPeriod = 0.08, kDecay = 0.99;  // s; per period
  const double periods = seconds / kPeriod;
  const bool anew = rng.Uniform() < random.value[kForceRate] * periods;
  if (!anew) return std::pow(kDecay, periods) * force;
  return NormalVector(rng, mass * random.value[kForce]);
}

}  // namespace dexremoe::internal
