// The same update on libtorch, in a program of its own (tests/bench/torch).
#pragma once

#include <string>

#include "policy/structure.h"
#include "rl/ppo_options.h"

namespace dexremoe {

// What the peer says of one run.
struct PeerUpdate {
  std::string version, blas;  // of libtorch; library of its matrix products
  double parameters = 0;      // of its network
  double wall = 0, cpu = 0;   // s per update: by the clock, processor time of all threads
  double peak_memory = 0;     // GiB, of its process
};

// Starts `program` with these sizes and ppo.precision (f32 or bf16) on `workers` threads and waits
// for its one CSV line. It warms up, then updates for `seconds`, at least once. Throws Error naming
// the program when it cannot be started, fails, or prints anything else.
PeerUpdate RunPeer(const std::string& program, const PpoOptions& ppo, const PolicyOptions& policy,
                   int workers, double seconds);

// version,blas,parameters,updates,seconds,processor seconds,GiB. Throws Error naming `program`.
PeerUpdate ParsePeer(const std::string& program, const std::string& line);

}  // namespace dexremoe
