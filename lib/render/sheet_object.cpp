#include "render/sheet_object.h"

#include <filesystem>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "io/csv.h"

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

SheetObject Described(const ObjectEntry& entry, const std::string& up) {
  SheetObject object;
  object.name = entry.name;
  object.category = entry.category;
  object.up = UpAxis(up, entry.mesh);
  return object;
}

}  // namespace

SheetObject ReadSourceObject(const ObjectEntry& entry, const std::string& up) {
  SheetObject object = Described(entry, up);
  object.mesh = LoadMesh(entry.mesh);
  return object;
}

SheetObject ReadSheetObject(const ObjectEntry& entry, const std::string& up, bool with_parts) {
  SheetObject object = Described(entry, up);
  object.mesh = ReadObjectMesh(entry.folder + "/mesh.h5").mesh;
  if (!with_parts) return object;
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
