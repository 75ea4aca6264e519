// The geometry of PointNet++ (Qi et al. 2017): which points form a neighbourhood. It depends on the
// cloud only, not on the weights, so it is done once per cloud, in float.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace dexremoe {

// Sizes of one set-abstraction level.
struct GroupSizes {
  int centroids = 0;
  double radius = 0;  // in unit-sphere units
  int neighbors = 0;  // at most so many points in a group
};

// Neighbourhoods of one level; groups are stored one after the other without padding. The original
// pads a group to `neighbors` rows with copies of its first point; the maximum over the rows of a
// group, all that is ever made of them, is the same without the copies, and so is its gradient.
struct Groups {
  std::vector<int> begin;    // [G+1]: rows begin[g] .. begin[g+1]-1 belong to group g
  std::vector<int> index;    // [rows]: point of the level below
  std::vector<float> local;  // [rows,3]: (point - centroid) / radius
  int count() const { return static_cast<int>(begin.size()) - 1; }
  int rows() const { return static_cast<int>(index.size()); }
};

// Centroids are the first `sizes.centroids` of xyz [N,3] (all, when there are fewer); a group takes
// the first `sizes.neighbors` points, by index, within the radius (closed ball) of its centroid.
// NOTE(paper): relative coordinates are divided by the radius, which the original does not do: all
// inputs of the first layers then have one size, and training without batch normalisation is
// stable.
Groups BallQuery(std::span<const float> xyz, const GroupSizes& sizes);

// Moves the points to their centroid and scales the farthest to distance 1. Throws Error for points
// that are not finite or all equal.
std::vector<Eigen::Vector3f> ToUnitSphere(std::span<const Eigen::Vector3f> points);

// A cloud ready for the network.
struct GroupedCloud {
  Groups level1, level2;
  std::vector<float> centers;  // [G2,3]: centroids of level 2, for the level that groups all
};

// Takes the points to the unit sphere, puts up to `max_points` of
// them in farthest-point order and groups them twice. The farthest-point order is computed once:
// the centroids of both levels are prefixes of it, exactly as if it were computed again at each
// level from the same first point. Throws Error for fewer than 4 points, points that are not finite
// or all equal.
GroupedCloud GroupCloud(std::span<const Eigen::Vector3f> points, int max_points,
                        const GroupSizes& sizes1, const GroupSizes& sizes2);

}  // namespace dexremoe
