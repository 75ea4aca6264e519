// Makes the builtin objects: recipes -> CATEGORY/NAME.ply and manifest.csv.
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "base/log.h"
#include "base/options.h"
#include "base/thread_pool.h"
#include "geometry/mesh_io.h"
#include "geometry/recipes.h"
#include "geometry/repair.h"
#include "io/atomic_file.h"
#include "io/csv.h"

namespace {

using namespace dexremoe;

constexpr double kLength = 0.1;  // longest side of every source mesh, m

std::vector<std::string> ManifestRow(const RecipeObject& recipe, const TriMesh& mesh) {
  const Eigen::Vector3d size = BoundsOf(mesh).Size();
  return {recipe.category,
          recipe.object_class,
          recipe.category + "/" + recipe.name + ".ply",
          fmt::format("{}", mesh.triangles.size()),
          fmt::format("{}", mesh.vertices.size()),
          TopologyOf(mesh).ClosedManifold() ? "1" : "0",
          fmt::format("{:.5f}", size.x()),
          fmt::format("{:.5f}", size.y()),
          fmt::format("{:.5f}", size.z()),
          fmt::format("{:.4f}", 1e6 * MassPropertiesOf(mesh).volume)};
}

}  // namespace

int main(int argc, char** argv) {
  Options options("make_objects",
                  "Makes meshes of the object recipes, 0.1 m long, one closed shell each.",
                  "make_objects --out=meshes/builtin");
  std::string out, recipes = "data/recipes";
  std::uint64_t seed = 1;
  int workers = 0;
  options.Add("out", &out, "folder to write CATEGORY/NAME.ply and manifest.csv to")
      .Required()
      .NotStored();
  options.Add("recipes", &recipes, "folder of CATEGORY/NAME.recipe files");
  options.Add("seed", &seed, "seed of the recipes' random parameters");
  options.Add("workers", &workers, "threads, 0: all processors").Range(0, 1024).NotStored();
  return RunTool(options, argc, argv, [&] {
    const std::vector<RecipeObject> files = FindRecipes(recipes);
    std::vector<std::vector<std::string>> rows(files.size());
    Progress progress("make_objects", static_cast<double>(files.size()));
    std::atomic<int> done = 0;
    ThreadPool pool(workers);
    pool.ParallelFor(static_cast<int>(files.size()), [&](int i, int worker) {
      const RecipeObject& file = files[i];
      const TriMesh mesh = MeshOfRecipe(LoadRecipe(file, seed), kLength, file.path);
      SaveMesh(out + "/" + file.category + "/" + file.name + ".ply", mesh);
      rows[i] = ManifestRow(file, mesh);
      ++done;
      if (worker == 0) progress.Update(done, file.name);
    });
    progress.Finish();
    CsvWriter manifest({"category", "class", "file", "triangles", "vertices", "closed", "bbox_x",
                        "bbox_y", "bbox_z", "volume_cm3"});
    for (const auto& row : rows) manifest.Row(row);
    WriteFile(out + "/manifest.csv", manifest.text());
    std::printf("objects: %zu\n", files.size());
    std::printf("manifest: %s/manifest.csv\n", out.c_str());
  });
}
