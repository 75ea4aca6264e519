// Statistics over the rows of all ranks; each rank hands in its own rows and gets the whole's
// figures.
#pragma once

#include <vector>

#include "nn/normalizer.h"
#include "rl/communicator.h"

namespace dexremoe {

// Moments that hold nothing yet, to be filled by UpdateMoments with the rows of one rank.
RunningMoments EmptyMoments(int columns);

// Merges the moments of all ranks' new rows into `moments`, which is equal on every rank.
void MergeMoments(Communicator& communicator, RunningMoments of_rank, RunningMoments& moments);

// Share of the targets' variance that the values explain.
double ExplainedVariance(Communicator& communicator, const std::vector<float>& value,
                         const std::vector<float>& target);

// Shifts and scales to mean 0 and variance 1 over the rows of all ranks.
void NormalizeAdvantages(Communicator& communicator, std::vector<float>& advantage);

}  // namespace dexremoe
