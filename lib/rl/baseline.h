// The methods that the paper compares itself with (its Table I), as first states of a training. All
// get the same reward and task; they differ in what they see, in their network and in how episodes
// are drawn.
#pragma once

#include <string>
#include <vector>

#include "rl/start.h"

namespace dexremoe {

// clang-format off
// | dr         | OpenAI et al. 2018: pose, goal and joints with noise, nothing privileged; randomised |
// | adr        | OpenAI et al. 2019: the same, with ranges that move                                  |
// | privfeat   | Hora (Qi et al. 2022): e_phys, neither shape nor category                            |
// | privshape  | RotateIt (Qi et al. 2023): e_phys and shape, no category                             |
// | res        | RESPRECT (Ceola et al. 2024): residual over the frozen base                          |
// | sparse_moe | Shazeer et al. 2017 (policy/sparse_moe.h)                                            |
// | switch     | Fedus et al. 2021 (policy/switch_moe.h)                                              |
// | mlore      | Yang et al. 2024 (policy/mlore_layer.h)                                              |
// | mmoe       | Ma et al. 2018 (policy/mmoe.h)                                                       |
// | base_long  | control: the base trained on                                                         |
// clang-format on
//
// NOTE(paper): it lets no method see less than its own definition, but does not say how DR and ADR
// see the object. Here in place of e_phys they get the columns that sensors could give, with noise
// (ObservableColumns); the value function sees no more.
const std::vector<std::string>& BaselineMethods();
// res and base_long: they go on from a base policy, whose samples count as theirs.
bool StartsFromBase(const std::string& method);
// dr and adr.
bool Randomizes(const std::string& method);

// `observable`: columns of e_phys for dr and adr. `base` is needed by methods that start from it
// and comes from `base_path`. Throws Error naming the file when it is no base policy.
TrainState StartBaseline(const std::string& method, const StageStart& start,
                         const PolicyOptions& policy, int obs_size, int phys_size, int num_actions,
                         const std::vector<int>& observable, const TrainState* base,
                         const std::string& base_path);

}  // namespace dexremoe
