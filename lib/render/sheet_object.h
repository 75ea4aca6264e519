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

// What of an object a sheet shows; kSources and kDataset: the source mesh as it is, before anything
// is made of it.
enum class SheetKind { kMeshes, kSources, kDataset, kParts, kClouds };
// "objects", "sources", "dataset", "parts" or "clouds".
SheetKind SheetKindNamed(const std::string& name);

// From the entry's folder mesh.h5, with its parts.h5 beside it, or in its place cloud.h5 as beads
// or the source mesh, as `kind` says. `up` as for UpAxis. Throws Error.
SheetObject ReadSheetObject(const ObjectEntry& entry, const std::string& up, SheetKind kind);

// One object of any file: a mesh file, mesh.h5, parts.h5 (parts alone) or cloud.h5 (beads). Throws
// Error for other files.
SheetObject ReadSheetFile(const std::string& path, const std::string& up);

// A small octahedron at every point.
TriMesh BeadsOf(const std::vector<Eigen::Vector3d>& points, double radius);

// Which way is up for an object: source meshes disagree (y in most, z in ours). "x", "y", "z",
// "-x",
// "-y" or "-z"; throws Error for another word. "auto" looks for the mesh in the column up_axis of
// FOLDER/manifest.csv for FOLDER/CATEGORY/NAME.ply and takes z where there is no such file, column
// or line.
Eigen::Vector3d UpAxis(const std::string& word, const std::string& mesh_path);

}  // namespace dexremoe
