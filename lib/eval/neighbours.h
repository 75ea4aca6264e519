// How much of a neighbourhood structure an embedding keeps, and clusters of points.
#pragma once

#include <cstdint>
#include <vector>

#include "base/thread_pool.h"

namespace dexremoe {

struct NeighbourPreservation {
  double overlap = 0;          // mean share of the k nearest neighbours that are kept, 0 .. 1
  double trustworthiness = 0;  // Venna and Kaski 2001; 1 = no false neighbours, 0.5 = chance
};

// x [n, d] against its embedding y [n, e]; 1 <= k < n / 2. Ties go to the lower index.
NeighbourPreservation ComparePositions(const std::vector<double>& x, int n, int d,
                                       const std::vector<double>& y, int e, int k,
                                       ThreadPool& pool);

struct Clustering {
  int clusters = 0;
  std::vector<int> label;  // [n], 0 .. clusters-1; larger clusters have lower numbers
  double silhouette = 0;   // mean over points (Rousseeuw 1987), -1 .. 1
};

// k-means (k-means++ starts, the best of 20) for every number of clusters from 2 to `most`; the
// one with the highest mean silhouette. One cluster when there are fewer than three distinct
// points.
Clustering ClusterPoints(const std::vector<double>& x, int n, int d, int most, std::uint64_t seed);

}  // namespace dexremoe
