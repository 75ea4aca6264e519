// The randomised parts of a control step; used when options.random.on.
#include <algorithm>

#include "task/reorient_impl.h"

namespace dexremoe {
namespace {

// Parts of an episode's stream of noise.
enum Part : std::uint64_t { kActionPart, kSightPart, kForcePart };

}  // namespace

Rng ReorientBatch::Impl::NoiseOf(int env, int part, int time) const {
  const internal::EpisodeKey key = KeyOf(env);
  return Rng(seed, Stream::kNoise,
             {key.object, key.episode, static_cast<std::uint64_t>(part),
              static_cast<std::uint64_t>(time)});
}

void ReorientBatch::Impl::StartRandom(int env, EnvPhysics& start) {
  const internal::RandomValues values =
      internal::DrawRandomValues(options.random, seed, KeyOf(env));
  std::copy(values.begin(), values.end(), &state.random[std::size_t{kNumRandom} * env]);
  std::fill_n(&state.last_action[static_cast<std::size_t>(env) * joints], joints, 0.0);
  std::fill_n(&state.force[3 * static_cast<std::size_t>(env)], 3, 0.0);
  randoms[env] = internal::MakeEpisodeRandom(values, seed, KeyOf(env), joints);
  internal::Randomize(randoms[env], start);
}

// After state and physics were restored: what the image leaves out, for it follows from the rest.
void ReorientBatch::Impl::RestoreRandom(int env) {
  internal::RandomValues values;
  std::copy_n(&state.random[std::size_t{kNumRandom} * env], kNumRandom, values.begin());
  randoms[env] = internal::MakeEpisodeRandom(values, seed, KeyOf(env), joints);
  EnvPhysics gains_and_gravity = physics[env];
  internal::Randomize(randoms[env], gains_and_gravity);
  physics[env].kp_factor = gains_and_gravity.kp_factor;
  physics[env].kd_factor = gains_and_gravity.kd_factor;
  physics[env].gravity = gains_and_gravity.gravity;
}

// Noise is drawn once a decision; a delayed action begins one control step into its decision.
std::vector<double> ReorientBatch::Impl::ActionOf(int env, const float* action) {
  const int step = state.length[env] % options.action_repeat;
  Rng rng = NoiseOf(env, kActionPart, state.length[env] / options.action_repeat);
  std::vector<double> now(joints);
  for (int j = 0; j < joints; ++j) now[j] = std::clamp(static_cast<double>(action[j]), -1.0, 1.0);
  internal::DisturbAction(randoms[env], rng, now);
  double* last = &state.last_action[static_cast<std::size_t>(env) * joints];
  if (step > 0 || !randoms[env].delayed) return now;
  std::vector<double> before(last, last + joints);
  std::copy(now.begin(), now.end(), last);
  return before;
}

// A joint's targets stay within its limits and the episode's, which never exclude where the target
// is: at the start that is the grasp's.
std::pair<double, double> ReorientBatch::Impl::TargetLimits(int env, int joint,
                                                            double target) const {
  const Joint& limits = hand.joints[joint];
  if (!options.random.on) return {limits.lower, limits.upper};
  const double low = std::max(limits.lower, limits.lower + randoms[env].lower[joint]);
  const double high = std::min(limits.upper, limits.upper + randoms[env].upper[joint]);
  return {std::min(low, target), std::max(high, target)};
}

void ReorientBatch::Impl::PushAtRandom(int env) {
  Rng rng = NoiseOf(env, kForcePart, state.length[env]);
  Eigen::Map<Eigen::Vector3d> force(&state.force[3 * static_cast<std::size_t>(env)]);
  force = internal::NextForce(randoms[env], physics[env].mass, 1 / control_rate, force, rng);
  if (!force.isZero(0)) sim->PushObject(env, force);
}

internal::Sight ReorientBatch::Impl::Look(int env) const {
  const double* q = &state.q[static_cast<std::size_t>(env) * joints];
  internal::Sight sight{motions[env], q, {}};
  if (!options.random.on) return sight;
  Rng rng = NoiseOf(env, kSightPart, state.length[env]);
  sight.motion.X_WO = internal::SeenPose(randoms[env], sight.motion.X_WO, rng);
  sight.joints.assign(q, q + joints);
  internal::SeeJoints(randoms[env], rng, sight.joints);
  sight.q = sight.joints.data();
  return sight;
}

}  // namespace dexremoe
