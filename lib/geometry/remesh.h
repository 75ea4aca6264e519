// From a level set on a grid to a closed manifold mesh.
#pragma once

#include <functional>

#include "geometry/distance_field.h"
#include "geometry/mesh.h"

namespace dexremoe {

// The surface where the grid's values cross `level`, wound outward (inside = below the level).
// Dual of marching cubes (Nielson 2004): one vertex per surface patch of a cell, one quad (two
// triangles) per crossed grid edge. Ambiguous cell faces are paired so that no edge of the result
// has more than two triangles (after Wenger, "Isosurfaces", 2013), so the mesh is always a closed
// manifold. Values on the border of the grid count as outside.
TriMesh ExtractLevelSet(const DistanceGrid& grid, double level);

// Moves every vertex onto the zero set of `field` along its gradient (by differences over `step`),
// at most `reach` away from where it was. Units as in the mesh.
void ProjectToField(const std::function<double(const Eigen::Vector3d&)>& field, double step,
                    double reach, TriMesh& mesh);

// `rounds` of Laplacian smoothing within the tangent plane: evens out the triangles, keeps the
// shape.
void SmoothTangentially(int rounds, TriMesh& mesh);

}  // namespace dexremoe
