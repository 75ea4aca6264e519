// Few rounded boxes that stand for a union of convex hulls.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace dexremoe {

// All points within `radius` of a box. A sphere where half is 0, a capsule where one extent is not.
struct RoundedBox {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();    // m
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns: directions of the extents
  Eigen::Vector3d half = Eigen::Vector3d::Zero();      // half extents, descending, >= 0; m
  double radius = 0;                                   // m
};

// Distance of p from the surface of the rounded box; negative inside; m.
double DistanceTo(const RoundedBox& box, const Eigen::Vector3d& p);

struct CoverOptions {
  double overhang = 0.5e-3;  // a box reaches so far out of a face plane of its hull at most; m
  // Rounding where the hull is thick enough, m. Less follows edges closer: they lose
  // (sqrt(2) - 1) r, corners (sqrt(3) - 1) r. More keeps the core away from the object's surface,
  // where its distance field is smoother.
  double radius = 4e-3;
  double gap = 1e-3;  // enough when the mean square gap over the surface is below its square; m
  int most = 6;       // boxes
  int extents = 3;    // of a box that may differ from 0: 1 gives capsules and spheres only
};

struct CoverBox {
  RoundedBox box;
  int hull;  // that holds it
};

// Covers the surface of the union of `hulls` (closed, convex). Candidates are boxes grown within
// single hulls. One after another is taken, each time the one that leaves the smallest sum of
// squared gaps over the surface (gap: how far a surface point lies outside the boxes), until `gap`
// or `most` is reached; then each is exchanged for a better one while that helps. Deterministic.
std::vector<CoverBox> CoverHulls(const ConvexParts& hulls, const CoverOptions& options = {});

}  // namespace dexremoe
