#include "eval/decompose_bench.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>

#include "base/error.h"
#include "eval/metrics.h"
#include "eval/peer_program.h"
#include "eval/sim_table.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "geometry/voxel_solid.h"
#include "io/csv.h"
#include "task/object_choice.h"

namespace dexremoe {
namespace {

constexpr const char* kPeerNote = ", libHACD";

// Processor time of the calling thread, s.
double ThreadTime() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Parts of a closed object and the processor time that they took, s.
struct TimedParts {
  ConvexParts parts;
  double seconds = 0;
};
using PartMaker = std::function<TimedParts(const ObjectMesh& object, const std::string& path)>;

TimedParts OurParts(const ObjectMesh& object, const std::string& path,
                    const DecomposeOptions& options) {
  const double start = ThreadTime();
  ConvexParts parts = DecomposeConvex(object.mesh, options, path);
  return {std::move(parts), ThreadTime() - start};
}

// Files go to and fro because the peer may crash: it is a process of its own.
TimedParts PeerParts(const ObjectMesh& object, const DecomposeBenchOptions& options) {
  namespace fs = std::filesystem;
  const std::string stem =
      fs::temp_directory_path() / fmt::format("dexremoe_peer_{}_{}", getpid(), object.name);
  const std::string mesh = stem + ".mesh.h5", parts = stem + ".parts.h5";
  WriteObjectMesh(mesh, object, {});
  const std::string output = OutputOf(
      options.peer, fmt::format("{} --mesh={} --out={} --parts={} --hull_vertices={}",
                                ShellQuoted(options.peer), ShellQuoted(mesh), ShellQuoted(parts),
                                options.decompose.parts, options.decompose.hull_vertices));
  TimedParts result = {ReadParts(parts).parts, std::strtod(output.c_str(), nullptr)};
  fs::remove(mesh);
  fs::remove(parts);
  return result;
}

DecomposedMesh MeasureFile(const std::string& path, const DecomposeBenchOptions& options,
                           const PartMaker& make) {
  DecomposedMesh result;
  result.name = std::filesystem::path(path).stem().string();
  const TriMesh source = LoadMesh(path);
  const double start = ThreadTime();
  ObjectMesh object = MakeObject(source, options.scale, path);
  object.name = result.name;
  result.repair_seconds = ThreadTime() - start;
  const auto [parts, seconds] = make(object, path);
  const TriMesh& mesh = object.mesh;
  result.seconds = seconds;
  result.source_triangles = static_cast<int>(source.triangles.size());
  result.triangles = static_cast<int>(mesh.triangles.size());
  result.parts = static_cast<int>(parts.size());
  result.diagonal = BoundsOf(mesh).Size().norm();
  result.source_ratio = object.source_distance / result.diagonal;
  result.voxel = VoxelSize(BoundsOf(mesh), options.decompose.resolution);
  result.quality = QualityOf(mesh, parts);
  return result;
}

// Every n-th mesh of a folder, one per thread at a time.
std::vector<DecomposedMesh> MeasureFolder(const std::string& folder, int every,
                                          const std::string& note,
                                          const DecomposeBenchOptions& options,
                                          const PartMaker& make, ThreadPool& pool) {
  const std::vector<MeshFile> files = ListMeshes(folder);
  const int count = (static_cast<int>(files.size()) + every - 1) / every;
  std::vector<DecomposedMesh> meshes(count);
  const std::string set = std::filesystem::path(folder + "/").parent_path().filename().string();
  pool.ParallelFor(count, [&](int i, int) {
    meshes[i] = MeasureFile(files[static_cast<std::size_t>(i) * every].path, options, make);
    meshes[i].set = set + note;
  });
  return meshes;
}

// The sets in order of appearance, each with its meshes.
std::vector<std::pair<std::string, std::vector<const DecomposedMesh*>>> BySet(
    const std::vector<DecomposedMesh>& meshes) {
  std::vector<std::pair<std::string, std::vector<const DecomposedMesh*>>> sets;
  for (const DecomposedMesh& mesh : meshes) {
    if (sets.empty() || sets.back().first != mesh.set) sets.push_back({mesh.set, {}});
    sets.back().second.push_back(&mesh);
  }
  return sets;
}

struct Column {
  const char* name;
  int decimals;
  std::function<double(const DecomposedMesh&)> value;
};

// Median with the 10th and 90th percentile of every column.
void Summarise(const std::string& table, const std::string& row,
               const std::vector<const DecomposedMesh*>& meshes, const std::vector<Column>& columns,
               std::vector<Measurement>& summary) {
  summary.push_back({table, row, "meshes", static_cast<double>(meshes.size()), 0, ""});
  for (const Column& column : columns) {
    std::vector<double> values;
    for (const DecomposedMesh* mesh : meshes) values.push_back(column.value(*mesh));
    std::sort(values.begin(), values.end());
    summary.push_back({table, row, column.name, Quantile(values, 0.5), column.decimals,
                       fmt::format("[{:.{}f}, {:.{}f}]", Quantile(values, 0.1), column.decimals,
                                   Quantile(values, 0.9), column.decimals)});
  }
}

std::vector<Measurement> Summary(const std::vector<DecomposedMesh>& meshes) {
  const std::vector<Column> parts = {
      {"parts", 0, [](const auto& m) { return m.parts; }},
      {"volume ratio", 2, [](const auto& m) { return m.quality.volume_ratio; }},
      {"Hausdorff, %", 2, [](const auto& m) { return 100 * m.quality.hausdorff_ratio; }},
      {"stick-out, voxels", 1, [](const auto& m) { return m.StickOut(); }},
      {"time, s", 2, [](const auto& m) { return m.seconds; }}};
  const std::vector<Column> repair = {
      {"triangles in", 0, [](const auto& m) { return m.source_triangles; }},
      {"triangles out", 0, [](const auto& m) { return m.triangles; }},
      {"distance, %", 2, [](const auto& m) { return 100 * m.source_ratio; }},
      {"time, s", 2, [](const auto& m) { return m.repair_seconds; }}};
  std::vector<Measurement> summary;
  for (const auto& [set, members] : BySet(meshes)) {
    Summarise("parts", set, members, parts, summary);
    if (!set.ends_with(kPeerNote)) Summarise("repair", set, members, repair, summary);
  }
  // Quoted: V-HACD 4.1 with 16 hulls, 64 vertices and 100 k voxels on closed versions of 150 real
  // meshes.
  const std::string peer = "V-HACD 4.1 (quoted)";
  summary.push_back({"parts", peer, "meshes", 150, 0, ""});
  summary.push_back({"parts", peer, "volume ratio", 1.52, 2, "[1.27, 2.42]"});
  summary.push_back({"parts", peer, "time, s", 1.2, 2, "[, 2.20]"});
  return summary;
}

}  // namespace

void DecomposeBenchOptions::Register(Options& options) {
  options.Add("every", &every, "takes every n-th mesh of a folder").Range(1, 1e6);
  options.Add("peer", &peer, "program that decomposes by libHACD; empty: none").NotStored();
  options.Add("peer_every", &peer_every, "which takes every n-th mesh of a folder").Range(1, 1e6);
  scale.Register(options);
  decompose.Register(options);
}

double DecomposedMesh::StickOut() const {
  return *std::max_element(quality.stick_out.begin(), quality.stick_out.end()) / voxel;
}

std::vector<DecomposedMesh> BenchFolder(const std::string& folder,
                                        const DecomposeBenchOptions& options, ThreadPool& pool) {
  return MeasureFolder(
      folder, options.every, "", options,
      [&](const ObjectMesh& object, const std::string& path) {
        return OurParts(object, path, options.decompose);
      },
      pool);
}

std::vector<DecomposedMesh> BenchPeerFolder(const std::string& folder,
                                            const DecomposeBenchOptions& options,
                                            ThreadPool& pool) {
  return MeasureFolder(
      folder, options.peer_every, kPeerNote, options,
      [&](const ObjectMesh& object, const std::string&) { return PeerParts(object, options); },
      pool);
}

std::string DecomposeMarkdown(const std::vector<DecomposedMesh>& meshes,
                              const DecomposeBenchOptions& options) {
  const std::vector<Measurement> summary = Summary(meshes);
  return fmt::format(
      "# Convex decomposition\n\n{}. At most {} parts of {} vertices, {} voxels. Median [10 %, "
      "90 %] over the meshes of a folder; times are processor time of one thread.\n\n{}\n"
      "Volume ratio: summed volume of the parts over that of the closed mesh. Hausdorff: symmetric "
      "distance between the mesh and the surface of the union of its parts, over the diagonal of "
      "the bounding box. Stick-out: how far the worst part gets outside the mesh. Time: from "
      "closed mesh to parts. V-HACD's figures (16 hulls, 64 vertices, 100 k voxels, closed "
      "versions of 150 real meshes) are quoted, not "
      "measured in this run; libHACD's, where it is installed, are measured on every {}th "
      "mesh.\n\n## Repair before it\n\n{}\n"
      "Distance: symmetric Hausdorff distance between the closed mesh and its source, over the "
      "diagonal. Time: scaling and mass properties included.\n",
      MachineText(), options.decompose.parts, options.decompose.hull_vertices,
      options.decompose.resolution, MarkdownOf(summary, "parts", "set"), options.peer_every,
      MarkdownOf(summary, "repair", "set"));
}

std::string DecomposeCsv(const std::vector<DecomposedMesh>& meshes) {
  CsvWriter csv({"set", "name", "source_triangles", "triangles", "source_ratio", "repair_seconds",
                 "seconds", "parts", "volume_ratio", "hausdorff_ratio", "stick_out_voxels"});
  for (const DecomposedMesh& m : meshes)
    csv.Row({m.set, m.name, fmt::format("{}", m.source_triangles), fmt::format("{}", m.triangles),
             fmt::format("{:.5f}", m.source_ratio), fmt::format("{:.3f}", m.repair_seconds),
             fmt::format("{:.3f}", m.seconds), fmt::format("{}", m.parts),
             fmt::format("{:.4f}", m.quality.volume_ratio),
             fmt::format("{:.5f}", m.quality.hausdorff_ratio),
             fmt::format("{:.2f}", m.StickOut())});
  return csv.text();
}

}  // namespace dexremoe
