#include <bit>
#include <cstdint>
#include <cstring>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY and STL are written little-endian");

template <typename T>
void Append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

void AppendFloats(std::string& bytes, const Eigen::Vector3d& v) {
  for (int k = 0; k < 3; ++k) Append(bytes, static_cast<float>(v[k]));
}

std::string PlyBytes(const TriMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment unit: m\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (const Eigen::Vector3d& v : mesh.vertices) AppendFloats(bytes, v);
  for (const auto& triangle : mesh.triangles) {
    Append(bytes, std::uint8_t{3});
    for (const int index : triangle) Append(bytes, static_cast<std::int32_t>(index));
  }
  return bytes;
}

std::string StlBytes(const TriMesh& mesh) {
  std::string bytes(80, ' ');
  Append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d& origin = mesh.vertices[a];
    const Eigen::Vector3d normal =
        (mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin).stableNormalized();
    AppendFloats(bytes, normal);
    for (const int index : {a, b, c}) AppendFloats(bytes, mesh.vertices[index]);
    Append(bytes, std::uint16_t{0});
  }
  return bytes;
}

// OBJ counts vertices from 1 through the whole file.
void AppendObj(std::string& text, const TriMesh& mesh, std::size_t first) {
  for (const Eigen::Vector3d& v : mesh.vertices)
    text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
  for (const auto& [a, b, c] : mesh.triangles)
    text += fmt::format("f {} {} {}\n", first + a, first + b, first + c);
}

bool EndsWith(const std::string& path, std::string_view ending) {
  return path.size() >= ending.size() &&
         path.compare(path.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace

void SaveMesh(const std::string& path, const TriMesh& mesh) {
  if (EndsWith(path, ".ply")) return WriteFile(path, PlyBytes(mesh));
  if (EndsWith(path, ".stl")) return WriteFile(path, StlBytes(mesh));
  if (!EndsWith(path, ".obj")) Fail("{}: expected a name ending in .ply, .obj or .stl", path);
  std::string text;
  AppendObj(text, mesh, 1);
  WriteFile(path, text);
}

void SaveParts(const std::string& path, const ConvexParts& parts) {
  if (!EndsWith(path, ".obj")) Fail("{}: expected a name ending in .obj", path);
  std::string text;
  std::size_t first = 1;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    text += fmt::format("g part_{:02}\n", i);
    AppendObj(text, parts[i], first);
    first += parts[i].vertices.size();
  }
  WriteFile(path, text);
}

}  // namespace dexremoe
