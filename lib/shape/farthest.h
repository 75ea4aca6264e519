// Farthest-point order: each point is the one farthest from all before it.
#pragma once

#include <span>
#include <vector>

namespace dexremoe {

// The first `count` indices of the farthest-point order of xyz [N,3]; count <= N. `start` is the
// first index; -1 takes the point farthest from the centroid. Among equally far points the lowest
// index wins, so the order is a function of the input alone, and the first k of it are the answer
// for every smaller count too.
std::vector<int> FarthestPointOrder(std::span<const float> xyz, int count, int start = -1);

}  // namespace dexremoe
