// PLY files (Turk 1994), text or binary of either byte order.
#pragma once

#include <string>

#include "geometry/mesh.h"

namespace dexremoe {

// Vertices and faces of the file with contents `bytes`; polygons become fans, other elements and
// properties are skipped. Throws Error (one line, naming `path`) for a bad header, an unknown type,
// a truncated body, vertices that are not finite, indices out of range, or no faces.
TriMesh ParsePly(const std::string& path, const std::string& bytes);

}  // namespace dexremoe
