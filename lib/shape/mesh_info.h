// What a file of a mesh, of an object, of its parts or of its cloud holds, in a few lines.
#pragma once

#include <string>

#include "geometry/mesh.h"

namespace dexremoe {

// Sum of the triangles' areas.
double AreaOf(const TriMesh& mesh);

// Counts, sizes and state of a mesh file, mesh.h5, parts.h5 or cloud.h5, as lines to print: a name,
// a colon and values; lengths in the file's own units for mesh files, else in mm. Throws Error.
std::string DescribeMeshFile(const std::string& path);

}  // namespace dexremoe
