// Approximate convex decomposition after V-HACD (Mamou, "Volumetric Hierarchical Approximate Convex
// Decomposition", Game Engine Gems 3, 2016).
#pragma once

#include <string>
#include <vector>

#include "base/options.h"
#include "geometry/mesh.h"

namespace dexremoe {

// NOTE(paper): the paper names V-HACD and none of its settings; 16 parts follow what the objects'
// details need, the volume error is V-HACD's default.
struct DecomposeOptions {
  int parts = 16;                   // at most
  int resolution = 60000;           // voxels in the bounding box
  double volume_error = 0.01;       // summed hull volume may exceed the solid by this share
  int hull_vertices = 32;           // per part, at most
  double balance = 0.05;            // weight of unequal halves against concavity (V-HACD's alpha)
  void Register(Options& options);  // section "decompose"
};

// Closed convex parts, outward, volume > 0, that together cover the solid up to the vertex limit.
// A mesh with holes is closed by a distance field first. Deterministic.
// Throws Error naming `label` when the mesh encloses no volume.
ConvexParts DecomposeConvex(const TriMesh& mesh, const DecomposeOptions& options,
                            const std::string& label = "mesh");

// How well parts stand for a closed mesh.
struct DecompositionQuality {
  double volume_ratio = 0;     // summed part volume / mesh volume
  std::vector<double> stick_out;  // of each part: how far its surface gets outside the mesh, m
  double hausdorff_ratio = 0;  // symmetric Hausdorff distance between the mesh's surface and the
                               // surface of the parts' union / diagonal of the mesh's bounding box;
                               // sampled, so a slight underestimate; slits inside the solid
                               // thinner than 1 % of the diagonal do not count
};
DecompositionQuality QualityOf(const TriMesh& mesh, const ConvexParts& parts);

}  // namespace dexremoe
