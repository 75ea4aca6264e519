#include <cstdint>
#include <cstring>
#include <filesystem>

#include "base/check.h"
#include "base/confined.h"
#include "base/error.h"
#include "geometry/mesh_import.h"
#include "geometry/mesh_io.h"
#include "geometry/ply.h"
#include "geometry/repair.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

std::string LowerExtension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

// What the file says its size is, so that a file cut short is noticed even where the reader
// underneath makes do with what is left. Zero where the format does not say.
std::size_t PromisedBytes(const std::string& extension, const std::string& bytes) {
  std::uint32_t word = 0;
  if (extension == ".stl" && bytes.size() >= 84 && bytes.compare(0, 5, "solid") != 0) {
    std::memcpy(&word, bytes.data() + 80, sizeof(word));
    return 84 + 50 * static_cast<std::size_t>(word);
  }
  if (extension == ".glb" && bytes.size() >= 12) std::memcpy(&word, bytes.data() + 8, sizeof(word));
  return word;
}

std::string Flat(const TriMesh& mesh) {
  const std::size_t counts[2] = {mesh.vertices.size(), mesh.triangles.size()};
  std::string bytes(reinterpret_cast<const char*>(counts), sizeof counts);
  bytes.append(reinterpret_cast<const char*>(mesh.vertices.data()),
               counts[0] * sizeof(mesh.vertices[0]));
  bytes.append(reinterpret_cast<const char*>(mesh.triangles.data()),
               counts[1] * sizeof(mesh.triangles[0]));
  return bytes;
}

TriMesh FromFlat(const std::string& bytes) {
  std::size_t counts[2];
  TriMesh mesh;
  DEX_CHECK_GE(bytes.size(), sizeof counts);
  std::memcpy(counts, bytes.data(), sizeof counts);
  const std::size_t vertex_bytes = counts[0] * sizeof(mesh.vertices[0]),
                    triangle_bytes = counts[1] * sizeof(mesh.triangles[0]);
  DEX_CHECK_EQ(bytes.size(), sizeof counts + vertex_bytes + triangle_bytes);
  mesh.vertices.resize(counts[0]);
  mesh.triangles.resize(counts[1]);
  std::memcpy(mesh.vertices.front().data(), bytes.data() + sizeof counts, vertex_bytes);
  std::memcpy(mesh.triangles.data(), bytes.data() + sizeof counts + vertex_bytes, triangle_bytes);
  return mesh;
}

// Devices and pipes may never end.
void CheckFile(const std::string& path, double max_megabytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    Fail("{}: expected a mesh file, found something else", path);
  const auto bytes = static_cast<double>(std::filesystem::file_size(path, error));
  if (!error && bytes > 1e6 * max_megabytes)
    Fail("{}: expected a mesh file of at most {} MB, found {:.0f} MB", path, max_megabytes,
         bytes / 1e6);
}

TriMesh Read(const std::string& path, const LoadLimits& limits) {
  CheckFile(path, limits.megabytes);
  const std::string bytes = ReadFile(path);
  if (bytes.empty()) Fail("{}: expected a mesh, found an empty file", path);
  const std::string extension = LowerExtension(path);
  // Assimp 5.2 misreads binary PLY whose first data byte looks like a line end.
  if (extension == ".ply") return ParsePly(path, bytes);
  const std::size_t promised = PromisedBytes(extension, bytes);
  if (bytes.size() < promised)
    Fail("{}: file is truncated: expected {} bytes, found {}", path, promised, bytes.size());
  if (!IsImportable(extension))
    Fail("{}: expected a mesh file (obj, stl, ply, off, dae, fbx, gltf, glb), found '{}'", path,
         extension);
  return FromFlat(RunConfined(path + ": reading it", limits.confined,
                              [&] { return Flat(ImportMesh(path, limits.triangles)); }));
}

}  // namespace

void LoadLimits::Register(Options& options) {
  options.Add("load.megabytes", &megabytes, "largest mesh file, MB").Range(0, 1e6);
  options.Add("load.triangles", &triangles, "most triangles of a file").Range(1, 1e9);
  options.Add("load.seconds", &confined.seconds, "processor time for reading a file, s")
      .Range(1, 1e6);
  options.Add("load.memory", &confined.memory, "memory for reading a file, GiB").Range(0.01, 1e3);
}

TriMesh LoadMesh(const std::string& path, const LoadLimits& limits) {
  const TriMesh mesh = Read(path, limits);
  if (mesh.triangles.size() > static_cast<std::size_t>(limits.triangles))
    Fail("{}: expected at most {} triangles, found {}", path, limits.triangles,
         mesh.triangles.size());
  return Weld(mesh, 0);
}

}  // namespace dexremoe
