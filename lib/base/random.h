// Random numbers. One --seed; every use draws from a stream addressed by purpose and indices, so
// results depend neither on the number of threads nor on the order of work.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>

namespace dexremoe {

// What a stream is for. Append only: the numbers enter the hash.
enum class Stream : std::uint64_t {
  kRecipe = 1,      // object recipe parameters
  kSplit,           // training / out-of-distribution split, choice of subsets
  kCloud,           // point sampling
  kAugment,         // cloud augmentation
  kInit,            // network initialisation
  kShuffle,         // minibatch order
  kGrasp,           // grasp search
  kReset,           // start of an episode
  kGoal,            // goal orientations
  kPhysical,        // object mass, friction, scale, ...
  kAction,          // exploration noise
  kDisturbance,     // pushes on the object
  kBootstrap,       // confidence intervals
  kEmbed,           // t-SNE
  kTest,            // tests
  kRouter,          // noise of a mixture's router
  kRandomize,       // randomised properties of an episode
  kNoise,           // noise of observations, actions and forces within an episode
};

// A 64-bit seed from the run's seed, the purpose and the indices (SplitMix64 finaliser, chained).
// Never use seed + index: neighbouring streams would overlap.
std::uint64_t SeedOf(std::uint64_t seed, Stream stream,
                     std::initializer_list<std::uint64_t> indices = {});

// SplitMix64 (Steele, Lea, Flood 2014). The whole state is one word, so it can be stored.
class Rng {
 public:
  explicit Rng(std::uint64_t state) : state_(state) {}
  Rng(std::uint64_t seed, Stream stream, std::initializer_list<std::uint64_t> indices = {})
      : state_(SeedOf(seed, stream, indices)) {}

  std::uint64_t Next();
  // Uniform in [0, 1).
  double Uniform();
  double Uniform(double low, double high);
  // Uniform in 0 .. n-1; n > 0.
  std::uint64_t Index(std::uint64_t n);
  // Standard normal (Box-Muller; two draws each, none cached).
  double Normal();
  // Haar-uniform unit quaternion, w x y z, w >= 0.
  std::array<double, 4> UnitQuaternion();

  std::uint64_t state() const { return state_; }
  void set_state(std::uint64_t state) { state_ = state; }

 private:
  std::uint64_t state_;
};

}  // namespace dexremoe
