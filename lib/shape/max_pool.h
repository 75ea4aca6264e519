// The maximum over the rows of each group, channel by channel.
#pragma once

#include <cstdint>
#include <vector>

#include "nn/bfloat16.h"

namespace dexremoe {

// y [rows,k]; group g holds rows begin[g] .. begin[g+1]-1, at least one. pooled, winner [groups,k]:
// the maximum and the first row that has it.
template <typename T>
void MaxPoolForward(const std::vector<int>& begin, int k, const T* y, T* pooled,
                    std::int32_t* winner);
// Sets dy [rows,k]: dpooled [groups,k] at the winners, zero elsewhere.
template <typename T>
void MaxPoolBackward(int groups, int rows, int k, const T* dpooled, const std::int32_t* winner,
                     T* dy);

}  // namespace dexremoe
