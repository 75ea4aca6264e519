// Random variants of a cloud for training.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/options.h"
#include "base/random.h"

namespace dexremoe {

struct AugmentOptions {
  double stretch = 0.1;       // each axis times U[1 - stretch, 1 + stretch]
  double thin = 0.5;          // at most this part of the points is left out
  double jitter = 0.01;       // normal noise, unit-sphere units (the original's)
  double jitter_clip = 0.05;  // its bound
  void Register(Options& options);
};

// A variant of unit-sphere `points`: stretched along each axis (scaling all axes alike would be
// undone by the scaling to the unit sphere), rotated Haar-uniformly over SO(3), thinned by a part
// drawn from U[0, thin] and jittered. At least 4 points stay.
std::vector<Eigen::Vector3f> AugmentCloud(std::span<const Eigen::Vector3f> points,
                                          const AugmentOptions& options, Rng& rng);

}  // namespace dexremoe
