// Splits an object into convex parts.
#include "geometry/decompose.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "base/options.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "geometry/voxel_solid.h"

namespace {

// Parts that bridge a hollow by more than voxels explain are named.
void PrintStickOut(const std::vector<double>& stick_out, double voxel) {
  constexpr double kExplained = 1.5;  // voxels
  std::printf("stick-out: %.2f mm at most\n",
              1e3 * *std::max_element(stick_out.begin(), stick_out.end()));
  for (std::size_t i = 0; i < stick_out.size(); ++i)
    if (stick_out[i] > kExplained * voxel)
      std::printf("stick-out of part %zu: %.2f mm, %.1f voxels\n", i, 1e3 * stick_out[i],
                  stick_out[i] / voxel);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("decompose", "Splits an object into convex parts (V-HACD's algorithm).",
                  "decompose --mesh=mesh.h5 --out=parts.h5 --decompose.parts=16");
  std::string mesh_path, out, export_path;
  DecomposeOptions decompose;
  options.Add("mesh", &mesh_path, "object file made by scale_mesh").Required();
  options.Add("out", &out, "file of the parts to write").Required().NotStored();
  options.Add("export", &export_path, "also write the parts as .obj, one group per part")
      .NotStored();
  decompose.Register(options);
  return RunTool(options, argc, argv, [&] {
    const ObjectMesh object = ReadObjectMesh(mesh_path);
    const auto start = std::chrono::steady_clock::now();
    ObjectParts result;
    result.parts = DecomposeConvex(object.mesh, decompose, mesh_path);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    const DecompositionQuality quality = QualityOf(object.mesh, result.parts);
    result.volume_ratio = quality.volume_ratio;
    result.hausdorff_ratio = quality.hausdorff_ratio;
    result.stick_out = quality.stick_out;
    if (!export_path.empty()) SaveParts(export_path, result.parts);
    WriteParts(out, result, MakeProvenance(options, 0, {mesh_path}));

    std::size_t most_vertices = 0;
    for (const TriMesh& part : result.parts)
      most_vertices = std::max(most_vertices, part.vertices.size());
    std::printf("name: %s (%s)\n", object.name.c_str(), object.category.c_str());
    std::printf("parts: %zu (at most %zu vertices each)\n", result.parts.size(), most_vertices);
    std::printf("volume ratio: %.4f\n", quality.volume_ratio);
    std::printf("hausdorff ratio: %.4f\n", quality.hausdorff_ratio);
    PrintStickOut(quality.stick_out, VoxelSize(BoundsOf(object.mesh), decompose.resolution));
    std::printf("time: %.2f s\n", elapsed.count());
  });
}
