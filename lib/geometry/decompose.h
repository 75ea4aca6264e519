// Approximate convex decomposition after V-HACD (Mamou, "Volumetric Hierarchical Approximate Convex
// Decomposition", Game Engine Gems 3, 2016).
#pragma once

#include <string>
#include <vector>

#include "base/options.h"
#include "geometry/mesh.h"

namespace dexremoe {

// NOTE(paper): the paper names V-HACD and none of its settings; 16 parts follow what the objects'
// details need, 64 vertices and the volume error are V-HACD's defaults. Beside excess volume, which
// is all that V-HACD's score sees, parts are chosen by their distance from the surface: thin gaps
// hold little volume.
struct DecomposeOptions {
  int parts = 16;              // at most
  int resolution = 60000;      // voxels in the bounding box
  double volume_error = 0.01;  // excess and concavity that are let be, as a share of the solid
  double concavity = 0.1;      // what a part that is 3 % of the diagonal off the surface weighs
  int hull_vertices = 64;      // per part, at most
  double balance = 0.05;       // weight of unequal halves against concavity (V-HACD's alpha)
  void Register(Options& options);  // section "decompose"
};

// Closed convex parts, outward, volume > 0, that together cover the solid up to the vertex limit.
// A mesh with holes is closed by a distance field first. Deterministic.
// Throws Error naming `label` when the mesh encloses no volume.
ConvexParts DecomposeConvex(const TriMesh& mesh, const DecomposeOptions& options,
                            const std::string& label = "mesh");

// How well parts stand for a closed mesh.
struct DecompositionQuality {
  double volume_ratio = 0;        // summed part volume / mesh volume
  std::vector<double> stick_out;  // of each part: how far its surface gets outside the mesh, m
  double hausdorff_ratio = 0;     // symmetric Hausdorff distance between the mesh's surface and the
                               // surface of the parts' union / diagonal of the mesh's bounding box;
                               // sampled, so a slight underestimate; slits inside the solid
                               // thinner than 1 % of the diagonal do not count
};
DecompositionQuality QualityOf(const TriMesh& mesh, const ConvexParts& parts);

}  // namespace dexremoe
