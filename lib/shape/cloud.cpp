#include "shape/cloud.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "shape/farthest.h"
#include "shape/normals.h"

namespace dexremoe {

void CloudOptions::Register(Options& options) {
  options.Add("cloud.points", &points, "points of the cloud").Range(16, 65536);
  options.Add("cloud.candidates", &candidates, "surface samples per point before thinning")
      .Range(1, 64);
  options
      .Add("cloud.normal_neighbors", &normal_neighbors,
           "samples that the plane of a normal is fitted to")
      .Range(3, 256);
}

PointCloud SampleSurface(const TriMesh& mesh, int count, Rng& rng) {
  std::vector<double> area_up_to(mesh.triangles.size());
  std::vector<Eigen::Vector3d> normal(mesh.triangles.size());
  double total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    normal[t] = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    total += normal[t].norm() / 2;
    area_up_to[t] = total;
    normal[t].normalize();
  }
  if (!(total > 0) || !std::isfinite(total))
    Fail("mesh: expected a surface with a positive area, found {} m^2", total);
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const auto found =
        std::upper_bound(area_up_to.begin(), area_up_to.end(), rng.Uniform() * total);
    const std::size_t t = std::min<std::size_t>(found - area_up_to.begin(), normal.size() - 1);
    const auto& [a, b, c] = mesh.triangles[t];
    const double root = std::sqrt(rng.Uniform()), along = rng.Uniform();
    cloud.points.push_back((1 - root) * mesh.vertices[a] + root * (1 - along) * mesh.vertices[b] +
                           root * along * mesh.vertices[c]);
    cloud.normals.push_back(normal[t]);
  }
  return cloud;
}

PointCloud SampleCloud(const TriMesh& mesh, const CloudOptions& options, std::uint64_t seed) {
  Rng rng(seed, Stream::kCloud);
  const PointCloud dense = SampleSurface(mesh, options.points * options.candidates, rng);
  std::vector<float> xyz;
  for (const Eigen::Vector3d& p : dense.points)
    for (int k = 0; k < 3; ++k) xyz.push_back(static_cast<float>(p[k]));
  PointCloud cloud;
  for (const int i : FarthestPointOrder(xyz, options.points)) {
    cloud.points.push_back(dense.points[i]);
    cloud.normals.push_back(dense.normals[i]);
  }
  FitNormals(dense.points, options.normal_neighbors, cloud);
  return cloud;
}

void WriteCloud(const std::string& path, const PointCloud& cloud, const Provenance& provenance) {
  const auto flat = [](const std::vector<Eigen::Vector3d>& vectors) {
    std::vector<double> values;
    for (const Eigen::Vector3d& v : vectors) values.insert(values.end(), v.data(), v.data() + 3);
    return values;
  };
  const auto count = static_cast<std::int64_t>(cloud.points.size());
  H5Writer file(path, kCloudFormat, provenance);
  file.Write("points", flat(cloud.points), {count, 3},
             {"m", "point, xyz", "surface points in frame O, in farthest-point order"});
  file.Write("normals", flat(cloud.normals), {count, 3},
             {"1", "point, xyz", "outward unit normals in frame O"});
  file.Commit();
}

PointCloud ReadCloud(const std::string& path) {
  const H5Reader file(path, kCloudFormat);
  const auto read = [&](const char* name, std::int64_t rows) {
    const std::vector<double> values = file.ReadValues<double>(name, {rows, 3});
    std::vector<Eigen::Vector3d> vectors;
    for (std::size_t i = 0; i < values.size(); i += 3) {
      vectors.emplace_back(values[i], values[i + 1], values[i + 2]);
      if (!vectors.back().allFinite())
        Fail("{}: {}: expected finite values, found {} in row {}", path, name,
             vectors.back().hasNaN() ? "nan" : "inf", i / 3);
    }
    return vectors;
  };
  PointCloud cloud;
  cloud.points = read("points", -1);
  if (cloud.points.size() < 4)
    Fail("{}: points: expected at least 4 points, found {}", path, cloud.points.size());
  cloud.normals = read("normals", static_cast<std::int64_t>(cloud.points.size()));
  return cloud;
}

}  // namespace dexremoe
