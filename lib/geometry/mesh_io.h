// Triangle meshes from and to the files that other programs use.
#pragma once

#include <string>

#include "base/confined.h"
#include "base/options.h"
#include "geometry/mesh.h"

namespace dexremoe {

// What a file may ask for before it is refused.
struct LoadLimits {
  double megabytes = 500;           // of the file
  int triangles = 2000000;          // of the mesh
  ConfinedLimits confined = {};     // of the library that reads what is not PLY
  void Register(Options& options);  // section "load"
};

// Reads OBJ, STL, PLY, OFF, DAE, FBX, glTF or GLB. All meshes of the scene are joined with their
// node transforms applied (mirroring transforms keep the winding outward), polygons are split into
// triangles, points and lines are left out, and vertices at exactly equal positions are merged.
// Units are the file's own. Throws Error (one line, naming the file) for a missing, empty,
// truncated or unreadable file, vertices that are not finite, files without faces, and files that
// exceed a limit or crash their reader.
TriMesh LoadMesh(const std::string& path, const LoadLimits& limits = {});

// Writes .ply (binary, 32-bit floats), .obj or .stl (binary) by the ending of `path`.
// Throws Error for another ending or when the file cannot be written.
void SaveMesh(const std::string& path, const TriMesh& mesh);

// Writes .obj with one group per part: `part_00`, `part_01`, ...
void SaveParts(const std::string& path, const ConvexParts& parts);

}  // namespace dexremoe
