#include "shape/mesh_info.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "geometry/repair.h"
#include "shape/cloud.h"

namespace dexremoe {
namespace {

// How lengths are shown: times `factor`, with `name` behind.
struct Unit {
  double factor;
  const char* name;
};
constexpr Unit kFileUnit = {1, "file units"};
constexpr Unit kMillimetre = {1e3, "mm"};

std::string Line(const char* name, const std::string& text) {
  return fmt::format("{:<14} {}\n", fmt::format("{}:", name), text);
}

std::string BoxLines(const Box3& box, const Unit& unit) {
  const Eigen::Vector3d size = unit.factor * box.Size(), center = unit.factor * box.Center();
  return Line("box",
              fmt::format("{:.4g} x {:.4g} x {:.4g} {}", size.x(), size.y(), size.z(), unit.name)) +
         Line("box centre", fmt::format("{:.4g} {:.4g} {:.4g} {}", center.x(), center.y(),
                                        center.z(), unit.name)) +
         Line("diagonal", fmt::format("{:.4g} {}", size.norm(), unit.name));
}

std::string SurfaceLines(const TriMesh& mesh, const Unit& unit) {
  const Topology topology = TopologyOf(Weld(mesh, 0));
  const bool closed = topology.ClosedManifold();
  const double area = unit.factor * unit.factor * AreaOf(mesh);
  const double volume = std::pow(unit.factor, 3) * MassPropertiesOf(mesh).volume;
  return Line("triangles",
              fmt::format("{} ({} vertices)", mesh.triangles.size(), mesh.vertices.size())) +
         BoxLines(BoundsOf(mesh), unit) +
         Line("area", fmt::format("{:.5g} {}^2", area, unit.name)) +
         Line("volume", closed ? fmt::format("{:.5g} {}^3", volume, unit.name)
                               : "unknown, the surface is not closed") +
         Line("shells", std::to_string(topology.shells)) +
         Line("closed", closed ? std::string("yes")
                               : fmt::format("no: {} open, {} crowded and {} flipped edges, {} "
                                             "pinched vertices",
                                             topology.open_edges, topology.crowded_edges,
                                             topology.flipped_edges, topology.pinched_vertices));
}

std::string DescribeObject(const std::string& path) {
  const ObjectMesh object = ReadObjectMesh(path);
  const Eigen::Vector3d inertia = 1e6 * object.inertia.diagonal();
  return Line("name", fmt::format("{} ({})", object.name, object.category)) +
         SurfaceLines(object.mesh, kMillimetre) +
         Line("mass",
              fmt::format("{:g} kg ({:.0f} kg/m^3)", object.mass, object.mass / object.volume)) +
         Line("inertia", fmt::format("{:.4g} {:.4g} {:.4g} kg mm^2 about the centre of mass",
                                     inertia.x(), inertia.y(), inertia.z())) +
         Line("repair", object.repair);
}

std::string DescribeParts(const std::string& path) {
  const ObjectParts parts = ReadParts(path);
  std::size_t least = SIZE_MAX, most = 0;
  double volume = 0;
  Box3 box;
  for (const TriMesh& part : parts.parts) {
    least = std::min(least, part.vertices.size());
    most = std::max(most, part.vertices.size());
    volume += 1e9 * MassPropertiesOf(part).volume;
    for (const Eigen::Vector3d& vertex : part.vertices) box.Extend(vertex);
  }
  return Line("parts", fmt::format("{} ({} to {} vertices)", parts.parts.size(), least, most)) +
         BoxLines(box, kMillimetre) + Line("volume", fmt::format("{:.5g} mm^3, summed", volume)) +
         Line("volume ratio", fmt::format("{:.4f} of the mesh", parts.volume_ratio)) +
         Line("hausdorff", fmt::format("{:.4f} of the diagonal", parts.hausdorff_ratio));
}

// Distance of each point to its nearest neighbour.
std::vector<double> Spacings(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> spacing(points.size(), INFINITY);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < points.size(); ++j)
      if (i != j) spacing[i] = std::min(spacing[i], (points[i] - points[j]).norm());
  std::sort(spacing.begin(), spacing.end());
  return spacing;
}

std::string DescribeCloud(const std::string& path) {
  const PointCloud cloud = ReadCloud(path);
  const std::vector<double> spacing = Spacings(cloud.points);
  Box3 box;
  for (const Eigen::Vector3d& p : cloud.points) box.Extend(p);
  return Line("points", std::to_string(cloud.points.size())) + BoxLines(box, kMillimetre) +
         Line("spacing", fmt::format("{:.3f} mm at the median, {:.3f} mm at least",
                                     1e3 * spacing[spacing.size() / 2], 1e3 * spacing.front()));
}

}  // namespace

double AreaOf(const TriMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area += (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
  return area / 2;
}

std::string DescribeMeshFile(const std::string& path) {
  if (std::filesystem::path(path).extension() != ".h5")
    return SurfaceLines(LoadMesh(path), kFileUnit);
  const std::string format = H5Reader(path).Attribute("format");
  if (format == kMeshFormat.name) return DescribeObject(path);
  if (format == kPartsFormat.name) return DescribeParts(path);
  if (format == kCloudFormat.name) return DescribeCloud(path);
  Fail("{}: expected {}, {} or {}, found {}", path, kMeshFormat.name, kPartsFormat.name,
       kCloudFormat.name, format);
}

}  // namespace dexremoe
