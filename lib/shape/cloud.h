// Point clouds of object surfaces: sampled evenly over the area, thinned to farthest points.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/options.h"
#include "base/random.h"
#include "geometry/mesh.h"
#include "io/h5.h"

namespace dexremoe {

inline constexpr H5Format kCloudFormat = {"dexremoe.cloud", 1};

struct PointCloud {
  std::vector<Eigen::Vector3d> points;   // m, in the mesh's frame
  std::vector<Eigen::Vector3d> normals;  // unit, outward; as many
};

struct CloudOptions {
  int points = 1024;          // paper: PointNet++'s input
  int candidates = 8;         // samples per point before thinning
  int normal_neighbors = 16;  // samples that a normal's plane is fitted to
  void Register(Options& options);
};

// `count` points drawn evenly over the surface: a triangle by its area, a point within it by
// Turk's square-root rule; normals are the triangles'. Throws Error when the mesh has no area.
PointCloud SampleSurface(const TriMesh& mesh, int count, Rng& rng);

// The cloud of an object: candidates by SampleSurface, their farthest-point subset in
// farthest-point order, and normals by PCL's plane fit over the candidates, turned to the side of
// the triangle each point came from.
PointCloud SampleCloud(const TriMesh& mesh, const CloudOptions& options, std::uint64_t seed);

void WriteCloud(const std::string& path, const PointCloud& cloud, const Provenance& provenance);
// Throws Error when the file is not a cloud, holds fewer than 4 points or values that are not
// finite.
PointCloud ReadCloud(const std::string& path);

// Binary PCD or PLY (by the ending .pcd or .ply) with normals, written through PCL. Throws Error.
void ExportCloud(const std::string& path, const PointCloud& cloud);

}  // namespace dexremoe
