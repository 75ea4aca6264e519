// A policy in a file, to act with: a checkpoint of any stage, or what is left of one without its
// training, a file of format dexremoe.weights.
//
// | dataset of dexremoe.weights             | dims, type      | meaning                           |
// | stage, method/*, structure/*, params/*, |                 | as in checkpoints, see            |
// |   block, normalizer/*, seed, samples,   |                 |   rl/checkpoint.h                 |
// |   table/*, example/*                    |                 |                                   |
// | params_hash                             | text            | HashOf all parameters in order    |
// | training/tool, training/options         | text            | that made the checkpoint          |
#pragma once

#include <string>

#include "io/h5.h"
#include "rl/train_state.h"

namespace dexremoe {

inline constexpr H5Format kWeightsFormat = {"dexremoe.weights", 1};

// Writes what the checkpoint `from` acts with to `path`. Throws Error.
void ExportWeights(const std::string& from, const std::string& path, const Provenance& provenance);

// What acting takes of a TrainState: stage, card, structure, seed, samples, table, normalizers and
// params; the rest is empty. Of either format. Throws Error naming file and dataset: another format
// or version, a block that is missing or of another width, other parameters than the hash says, an
// example whose output this build does not reproduce.
TrainState ReadPolicy(const std::string& path);

// Of the policy in it, alone. Throws Error.
PolicyStructure ReadPolicyStructure(const std::string& path);

}  // namespace dexremoe
