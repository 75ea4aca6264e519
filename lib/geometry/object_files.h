// The two files that describe an object to the rest of the chain: mesh.h5 and parts.h5.
#pragma once

#include <string>

#include "geometry/mesh.h"
#include "io/h5.h"

namespace dexremoe {

inline constexpr H5Format kMeshFormat = {"dexremoe.mesh", 1};
inline constexpr H5Format kPartsFormat = {"dexremoe.parts", 1};

// An object ready for use: closed, scaled, its frame O at the centre of mass.
struct ObjectMesh {
  TriMesh mesh;                                       // in O, m
  double mass = 0;                                    // kg
  double volume = 0;                                  // m^3
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about O; kg m^2
  std::string name;
  std::string category;
  std::string repair;          // what was done to close it
  double source_distance = 0;  // symmetric Hausdorff distance to the source's surface, m
  Eigen::Matrix4d source_to_object = Eigen::Matrix4d::Identity();  // source file units to O
};

// The convex pieces that physics collides with, and how well they fit.
struct ObjectParts {
  ConvexParts parts;           // in O, m; each closed and convex
  double volume_ratio = 0;     // summed hull volume / mesh volume
  double hausdorff_ratio = 0;  // symmetric Hausdorff distance / diagonal of the bounding box
  std::vector<double> stick_out =
      {};  // of each part, or empty: how far it gets outside the mesh, m
};

void WriteObjectMesh(const std::string& path, const ObjectMesh& object,
                     const Provenance& provenance);
// Throws Error naming file, dataset, expected and found.
ObjectMesh ReadObjectMesh(const std::string& path);

void WriteParts(const std::string& path, const ObjectParts& parts, const Provenance& provenance);
ObjectParts ReadParts(const std::string& path);

}  // namespace dexremoe
