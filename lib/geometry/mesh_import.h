// Mesh files through assimp.
#pragma once

#include <string>

#include "geometry/mesh.h"

namespace dexremoe {

// Whether assimp reads files with this extension (".obj").
bool IsImportable(const std::string& extension);

// All meshes of the scene joined, see LoadMesh. Assimp trusts its input: run this confined.
// Throws Error for what assimp refuses, vertices that are not finite, indices out of range, no
// faces, and more than `max_triangles`.
TriMesh ImportMesh(const std::string& path, int max_triangles);

}  // namespace dexremoe
