// One object of an overview, read from its files.
#pragma once

#include <Eigen/Core>
#include <string>

#include "geometry/mesh.h"
#include "task/object_set.h"

namespace dexremoe {

struct SheetObject {
  std::string name;
  std::string category;
  TriMesh mesh;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // stands upright, in the mesh's frame
  ConvexParts parts;                              // empty when not asked for
  std::string detail;                             // second line of the caption; may be empty
};

// mesh.h5 and, with `with_parts`, parts.h5 of the entry's folder. `up` as for UpAxis. Throws Error.
SheetObject ReadSheetObject(const ObjectEntry& entry, const std::string& up, bool with_parts);

// The entry's source mesh as it is, for pictures before anything is made of it. Throws Error.
SheetObject ReadSourceObject(const ObjectEntry& entry, const std::string& up);

// Which way is up for an object: source meshes disagree (y in most, z in ours). "x", "y", "z",
// "-x",
// "-y" or "-z"; throws Error for another word. "auto" looks for the mesh in the column up_axis of
// FOLDER/manifest.csv for FOLDER/CATEGORY/NAME.ply and takes z where there is no such file, column
// or line.
Eigen::Vector3d UpAxis(const std::string& word, const std::string& mesh_path);

}  // namespace dexremoe
