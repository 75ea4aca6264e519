// The ranks of an MPI launcher; used by communicator.cpp alone.
#pragma once

#include <memory>

#include "rl/communicator.h"

namespace dexremoe {

// Whether mpirun, srun or the like started this process; asks the environment, not MPI.
bool StartedByMpi();

// Initialises MPI. Throws Error when it does not offer threads.
std::unique_ptr<Communicator> MakeMpiCommunicator();

}  // namespace dexremoe
