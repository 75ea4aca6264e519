#include "render/sheet_object.h"

#include <filesystem>

#include "base/check.h"
#include "base/error.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "io/csv.h"
#include "shape/cloud.h"

namespace dexremoe {
namespace {

std::string AxisInManifest(const std::filesystem::path& mesh) {
  const std::filesystem::path manifest = mesh.parent_path().parent_path() / "manifest.csv";
  std::error_code code;
  if (!std::filesystem::is_regular_file(manifest, code)) return "z";
  const CsvTable table = CsvTable::Read(manifest.string());
  if (!table.HasColumn("file") || !table.HasColumn("up_axis")) return "z";
  const std::vector<std::string> files = table.Text("file"), axes = table.Text("up_axis");
  for (std::size_t i = 0; i < files.size(); ++i)
    if (manifest.parent_path() / files[i] == mesh) return axes[i];
  return "z";
}

TriMesh CloudBeads(const std::string& path) {
  const std::vector<Eigen::Vector3d> points = ReadCloud(path).points;
  Box3 box;
  for (const Eigen::Vector3d& p : points) box.Extend(p);
  return BeadsOf(points, 0.008 * box.Size().norm());
}

}  // namespace

SheetKind SheetKindNamed(const std::string& name) {
  if (name == "objects") return SheetKind::kMeshes;
  if (name == "sources") return SheetKind::kSources;
  if (name == "dataset") return SheetKind::kDataset;
  if (name == "parts") return SheetKind::kParts;
  DEX_CHECK_EQ(name, "clouds");
  return SheetKind::kClouds;
}

TriMesh BeadsOf(const std::vector<Eigen::Vector3d>& points, double radius) {
  constexpr int kCorners[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  TriMesh beads;
  for (const Eigen::Vector3d& p : points) {
    const int first = static_cast<int>(beads.vertices.size());
    for (int k = 0; k < 6; ++k)
      beads.vertices.push_back(p + (k % 2 == 0 ? radius : -radius) * Eigen::Vector3d::Unit(k / 2));
    for (const auto& [a, b, c] : kCorners)
      beads.triangles.push_back({first + a, first + b, first + c});
  }
  return beads;
}

SheetObject ReadSheetFile(const std::string& path, const std::string& up) {
  SheetObject object;
  const std::filesystem::path file(path);
  object.name = file.stem().string();
  object.up = UpAxis(up, path);
  if (file.extension() != ".h5") {
    object.mesh = LoadMesh(path);
    return object;
  }
  const std::string format = H5Reader(path).Attribute("format");
  if (format == kMeshFormat.name) {
    const ObjectMesh mesh = ReadObjectMesh(path);
    object.category = mesh.category;
    object.mesh = mesh.mesh;
  } else if (format == kPartsFormat.name) {
    object.parts = ReadParts(path).parts;
  } else if (format == kCloudFormat.name) {
    object.mesh = CloudBeads(path);
  } else {
    Fail("{}: expected {}, {} or {}, found {}", path, kMeshFormat.name, kPartsFormat.name,
         kCloudFormat.name, format);
  }
  return object;
}

SheetObject ReadSheetObject(const ObjectEntry& entry, const std::string& up, SheetKind kind) {
  SheetObject object;
  object.name = entry.name;
  object.category = entry.category;
  object.up = UpAxis(up, entry.mesh);
  if (kind == SheetKind::kSources || kind == SheetKind::kDataset)
    object.mesh = LoadMesh(entry.mesh);
  else if (kind == SheetKind::kClouds)
    object.mesh = CloudBeads(entry.folder + "/cloud.h5");
  else
    object.mesh = ReadObjectMesh(entry.folder + "/mesh.h5").mesh;
  if (kind != SheetKind::kParts) return object;
  ObjectParts parts = ReadParts(entry.folder + "/parts.h5");
  object.detail = fmt::format("{} parts, volume ratio {:.2f}, Hausdorff {:.1f} %",
                              parts.parts.size(), parts.volume_ratio, 100 * parts.hausdorff_ratio);
  object.parts = std::move(parts.parts);
  return object;
}

Eigen::Vector3d UpAxis(const std::string& word, const std::string& mesh_path) {
  const std::string axis = word == "auto" ? AxisInManifest(mesh_path) : word;
  const bool minus = !axis.empty() && axis[0] == '-';
  const std::string letter = axis.substr(minus ? 1 : 0);
  if (letter != "x" && letter != "y" && letter != "z")
    Fail("up axis of {}: expected x, y, z, -x, -y or -z, found \"{}\"", mesh_path, axis);
  return (minus ? -1 : 1) * Eigen::Vector3d::Unit(letter[0] - 'x');
}

}  // namespace dexremoe
