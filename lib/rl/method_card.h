// What a method is, in words: printed when its training starts, stored in its checkpoint, listed by
// list_methods.
#pragma once

#include <string>
#include <vector>

#include "policy/structure.h"
#include "rl/ppo_options.h"

namespace dexremoe {

struct MethodCard {
  std::string inputs;      // of the networks
  std::string network;     // and what of it is trained
  std::string losses;      // beside PPO's
  std::string curriculum;  // and randomisation
};

MethodCard DescribeMethod(const std::string& method, const PolicyStructure& structure,
                          const PpoOptions& ppo);

// The checkpoints' methods as a Markdown table. Throws Error naming the file that is none; with
// `missing`, files that are not there get a row that says so.
std::string MethodTable(const std::vector<std::string>& checkpoints, bool missing = false);

}  // namespace dexremoe
