// Everything a training run is, apart from its options: what a checkpoint holds.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "nn/adam.h"
#include "nn/normalizer.h"
#include "policy/shape_table.h"
#include "policy/structure.h"
#include "rl/adr.h"
#include "rl/curriculum.h"
#include "rl/method_card.h"

namespace dexremoe {

struct Normalizers {
  RunningMoments obs, phys, feature;  // inputs; frozen once the base is trained
  RunningMoments value{1};            // returns; follows every stage
  double clip = 5;                    // of the inputs
};

// One line of the learning curve; columns as kCurveColumns.
inline constexpr std::array<const char*, 26> kCurveColumns = {"iteration",
                                                              "samples",
                                                              "successes_per_episode",
                                                              "successes_per_600",
                                                              "drop_rate",
                                                              "mean_distance",
                                                              "mean_angle",
                                                              "episode_length",
                                                              "return",
                                                              "episodes",
                                                              "kl",
                                                              "learning_rate",
                                                              "log_std",
                                                              "policy_loss",
                                                              "value_loss",
                                                              "explained_variance",
                                                              "clip_fraction",
                                                              "gradient_norm",
                                                              "goal_angle",
                                                              "velocity_tolerance",
                                                              "gravity_factor",
                                                              "objects",
                                                              "routing_entropy",
                                                              "expert_load_least",
                                                              "expert_load_most",
                                                              "auxiliary_loss"};
using CurveRow = std::array<double, kCurveColumns.size()>;

// What decides between two states of one run: how far the curriculum had come, then success at that
// difficulty.
struct RunScore {
  // Goal angle over velocity tolerance, times the share of objects, and the factor on gravity:
  // grows with the curriculum.
  double progress = 0;
  double successes = -1;  // per episode, mean over the window
  auto operator<=>(const RunScore&) const = default;
};

struct TrainState {
  std::string stage;  // "base", "expert", "gate", or the baseline's name
  MethodCard card;
  PolicyStructure structure;
  std::uint64_t seed = 0;  // with the counters, all random streams
  ShapeTable table;        // the objects trained on
  Normalizers normalizers;
  std::vector<float> params;  // in the order of the policy's layout
  AdamState adam;             // over the trainable blocks, in the order of the layout
  double learning_rate = 0;
  std::int64_t iteration = 0, samples = 0;
  CurriculumState curriculum;
  AdrState adr;                       // empty without it
  std::vector<EpisodeRecord> window;  // last ended episodes, oldest first
  std::int64_t settled = 0;           // episodes ended since the difficulty last changed
  RunScore best;                      // highest so far
  std::vector<CurveRow> curve;        // one per iteration
  // VecEnv::Save of every rank; empty: episodes start anew.
  std::vector<std::vector<std::uint8_t>> environment;
};

}  // namespace dexremoe
