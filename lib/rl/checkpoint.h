// Files of format dexremoe.checkpoint: base.h5, expert_*.h5, gate.h5.
//
// | dataset                               | dims, type       | meaning                           |
// | stage                                 | text             | base, expert, gate or a baseline  |
// | method/*                              | text             | MethodCard                        |
// | structure/*                           | text, i32        | PolicyStructure, field by field   |
// | params/BLOCK                          | [rows,cols] f32  | parameters, a dataset per block   |
// | block, trainable                      | [B] text, u8     | in order; 1 where training may go |
// | adam/m, /v, /step                     | [P] f32, i64     | over the trainable blocks         |
// | learning_rate                         | f64              | the next one                      |
// | normalizer/NAME/mean,variance,count   | [c] f64          | of obs, phys, feature, value      |
// | normalizer/clip                       | f64              | limit of normalised inputs        |
// | seed, iteration, samples              | u64, i64         | with these, every random stream   |
// | curriculum/*                          | f64, i64, u8     | difficulty, and the next decision |
// | adr/*                                 | f64, i64         | AdrState, of ADR alone            |
// | window                                | [W,9] f64        | last ended episodes               |
// | best/progress, /successes, settled    | f64, i64         | RunScore, TrainState::settled     |
// | curve/column, curve/row               | [25] text, [I,25] f64 | without wall clock           |
// | table/name, /feature, /category       | [K]              | objects trained on                |
// | environment, environment_end          | [bytes] u8, [ranks] i64 | VecEnv::Save; none in best |
// | example/*                             | f32, i32         | normalised inputs and outputs     |
//
// A resumed run continues bit for bit; the file holds no wall clock, so equal runs give equal
// bytes.
#pragma once

#include <string>

#include "io/h5.h"
#include "rl/train_state.h"

namespace dexremoe {

inline constexpr H5Format kCheckpointFormat = {"dexremoe.checkpoint", 1};

// Written whole or not at all.
void WriteCheckpoint(const std::string& path, const TrainState& state,
                     const Provenance& provenance);

// Throws Error naming file and dataset: another format or version, a block that is missing or of
// another width, an example whose output this build does not reproduce.
TrainState ReadCheckpoint(const std::string& path);

// Throws Error naming the first option that differs from those the checkpoint was written with;
// `samples` may differ, so that a run can be made longer.
void CheckSameOptions(const std::string& path, const std::string& options);

}  // namespace dexremoe
