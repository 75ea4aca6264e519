#include "geometry/object_files.h"

#include <cstdint>
#include <span>

#include "base/error.h"

namespace dexremoe {
namespace {

using Matrix4r = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Matrix3r = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

void AppendFlat(const TriMesh& mesh, std::vector<double>& vertices,
                std::vector<std::int32_t>& triangles) {
  for (const Eigen::Vector3d& v : mesh.vertices)
    vertices.insert(vertices.end(), v.begin(), v.end());
  for (const auto& t : mesh.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
}

TriMesh FromFlat(const std::string& path, std::span<const double> vertices,
                 std::span<const std::int32_t> triangles) {
  TriMesh mesh;
  const int count = static_cast<int>(vertices.size() / 3);
  for (int i = 0; i < count; ++i) {
    mesh.vertices.emplace_back(vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]);
    if (!mesh.vertices.back().allFinite())
      Fail("{}: vertices: expected finite coordinates, found row {} not finite", path, i);
  }
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    const std::array<int, 3> triangle = {triangles[i], triangles[i + 1], triangles[i + 2]};
    for (const int index : triangle)
      if (index < 0 || index >= count)
        Fail("{}: triangles: expected indices in 0..{}, found {}", path, count - 1, index);
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

// Row offsets 0 = o_0 < o_1 < ... < o_P = rows.
void CheckOffsets(const std::string& path, const char* name,
                  const std::vector<std::int32_t>& offsets, std::size_t rows) {
  bool good = offsets.size() >= 2 && offsets.front() == 0 &&
              offsets.back() == static_cast<std::int64_t>(rows);
  for (std::size_t i = 1; good && i < offsets.size(); ++i) good = offsets[i] > offsets[i - 1];
  if (!good) Fail("{}: {}: expected rising offsets from 0 to {}, found others", path, name, rows);
}

}  // namespace

void WriteObjectMesh(const std::string& path, const ObjectMesh& object,
                     const Provenance& provenance) {
  std::vector<double> vertices;
  std::vector<std::int32_t> triangles;
  AppendFlat(object.mesh, vertices, triangles);
  const Matrix3r inertia = object.inertia;
  const Matrix4r transform = object.source_to_object;
  const auto rows = [](const auto& flat) { return static_cast<std::int64_t>(flat.size() / 3); };

  H5Writer file(path, kMeshFormat, provenance);
  file.Write("vertices", vertices, {rows(vertices), 3},
             {"m", "vertex, xyz", "frame O: origin at the centre of mass"});
  file.Write("triangles", triangles, {rows(triangles), 3},
             {"1", "triangle, corner", "vertex indices, counter-clockwise from outside"});
  file.WriteScalar("mass", object.mass, {"kg", "", "set by configuration"});
  file.WriteScalar("volume", object.volume, {"m^3", "", "by the divergence theorem"});
  file.Write("inertia", std::vector<double>(inertia.data(), inertia.data() + 9), {3, 3},
             {"kg m^2", "row, column", "about O, uniform density"});
  file.Write("source_to_object", std::vector<double>(transform.data(), transform.data() + 16),
             {4, 4},
             {"1", "row, column", "homogeneous transform from the source file's units to O"});
  file.WriteString("name", object.name, {"1", "", "object name"});
  file.WriteString("category", object.category, {"1", "", "object category"});
  file.WriteString("repair", object.repair, {"1", "", "what was done to make one closed shell"});
  file.WriteScalar("source_distance", object.source_distance,
                   {"m", "", "symmetric Hausdorff distance to the source's surface"});
  file.Commit();
}

ObjectMesh ReadObjectMesh(const std::string& path) {
  const H5Reader file(path, kMeshFormat);
  ObjectMesh object;
  object.mesh = FromFlat(path, file.ReadValues<double>("vertices", {-1, 3}),
                         file.ReadValues<std::int32_t>("triangles", {-1, 3}));
  object.mass = file.ReadScalar<double>("mass");
  object.volume = file.ReadScalar<double>("volume");
  object.inertia = Matrix3r(file.ReadValues<double>("inertia", {3, 3}).data());
  object.source_to_object = Matrix4r(file.ReadValues<double>("source_to_object", {4, 4}).data());
  object.name = file.ReadString("name");
  object.category = file.ReadString("category");
  object.repair = file.ReadString("repair");
  if (file.Has("source_distance"))  // files of earlier versions lack it
    object.source_distance = file.ReadScalar<double>("source_distance");
  if (!(object.mass > 0)) Fail("{}: mass: expected more than 0 kg, found {}", path, object.mass);
  if (!(object.volume > 0))
    Fail("{}: volume: expected more than 0 m^3, found {}", path, object.volume);
  return object;
}

void WriteParts(const std::string& path, const ObjectParts& object, const Provenance& provenance) {
  std::vector<double> vertices;
  std::vector<std::int32_t> triangles, vertex_offset = {0}, triangle_offset = {0};
  for (const TriMesh& part : object.parts) {
    AppendFlat(part, vertices, triangles);
    vertex_offset.push_back(static_cast<std::int32_t>(vertices.size() / 3));
    triangle_offset.push_back(static_cast<std::int32_t>(triangles.size() / 3));
  }
  const auto offsets = static_cast<std::int64_t>(vertex_offset.size());

  H5Writer file(path, kPartsFormat, provenance);
  file.Write("vertices", vertices, {vertex_offset.back(), 3},
             {"m", "vertex, xyz", "frame O; the parts' vertices one after the other"});
  file.Write("vertex_offset", vertex_offset, {offsets},
             {"1", "part", "first vertex of each part, then the number of vertices"});
  file.Write("triangles", triangles, {triangle_offset.back(), 3},
             {"1", "triangle, corner", "indices within the part, counter-clockwise from outside"});
  file.Write("triangle_offset", triangle_offset, {offsets},
             {"1", "part", "first triangle of each part, then the number of triangles"});
  file.WriteScalar("volume_ratio", object.volume_ratio,
                   {"1", "", "summed volume of the parts over the volume of the mesh"});
  file.WriteScalar("hausdorff_ratio", object.hausdorff_ratio,
                   {"1", "", "symmetric Hausdorff distance of the surfaces over the diagonal"});
  if (!object.stick_out.empty())
    file.Write("stick_out", object.stick_out, {static_cast<std::int64_t>(object.parts.size())},
               {"m", "part", "how far the part gets outside the mesh"});
  file.Commit();
}

ObjectParts ReadParts(const std::string& path) {
  const H5Reader file(path, kPartsFormat);
  const auto vertices = file.ReadValues<double>("vertices", {-1, 3});
  const auto triangles = file.ReadValues<std::int32_t>("triangles", {-1, 3});
  const auto vertex_offset = file.ReadValues<std::int32_t>("vertex_offset", {-1});
  const auto triangle_offset =
      file.ReadValues<std::int32_t>("triangle_offset", {static_cast<int>(vertex_offset.size())});
  CheckOffsets(path, "vertex_offset", vertex_offset, vertices.size() / 3);
  CheckOffsets(path, "triangle_offset", triangle_offset, triangles.size() / 3);
  ObjectParts object;
  const auto rows = [](const auto& flat, const auto& offset, std::size_t part) {
    return std::span(flat).subspan(3 * offset[part], 3 * (offset[part + 1] - offset[part]));
  };
  for (std::size_t i = 0; i + 1 < vertex_offset.size(); ++i)
    object.parts.push_back(
        FromFlat(path, rows(vertices, vertex_offset, i), rows(triangles, triangle_offset, i)));
  object.volume_ratio = file.ReadScalar<double>("volume_ratio");
  object.hausdorff_ratio = file.ReadScalar<double>("hausdorff_ratio");
  if (file.Has("stick_out"))  // files of earlier versions lack it
    object.stick_out =
        file.ReadValues<double>("stick_out", {static_cast<std::int64_t>(object.parts.size())});
  return object;
}

}  // namespace dexremoe
