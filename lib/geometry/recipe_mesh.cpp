#include <algorithm>
#include <filesystem>
#include <tuple>

#include "base/error.h"
#include "geometry/distance_field.h"
#include "geometry/recipes.h"
#include "geometry/remesh.h"
#include "geometry/repair.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

constexpr double kReach = 8;  // recipes live within +-kReach units
// Blends, tapers and lofts overstate distances; blocks are skipped only with this much to spare.
constexpr double kSlack = 2;

// Bounding box of the inside, from cubes that are split while the surface may pass through them.
void ExtendBounds(const Field& field, const Eigen::Vector3d& center, double half, double smallest,
                  Box3& bounds) {
  const double value = field(center);
  if (value > kSlack * std::sqrt(3.0) * half) return;
  if (half <= smallest) {
    if (value > std::sqrt(3.0) * half) return;
    bounds.Extend(center - Eigen::Vector3d::Constant(half));
    bounds.Extend(center + Eigen::Vector3d::Constant(half));
    return;
  }
  const Box3 cube = {center - Eigen::Vector3d::Constant(half),
                     center + Eigen::Vector3d::Constant(half)};
  if ((cube.min.array() >= bounds.min.array()).all() &&
      (cube.max.array() <= bounds.max.array()).all())
    return;  // nothing to gain
  for (int child = 0; child < 8; ++child) {
    const Eigen::Vector3d side(child & 1 ? 1 : -1, child & 2 ? 1 : -1, child & 4 ? 1 : -1);
    ExtendBounds(field, center + side * half / 2, half / 2, smallest, bounds);
  }
}

DistanceGrid FilledGrid(const Field& field, const Box3& bounds, int resolution) {
  DistanceGrid grid = GridAround(bounds, resolution, 2);
  constexpr int kBlock = 6;
  const double enough = kSlack * std::sqrt(3.0) * (kBlock / 2.0 + 1) * grid.spacing;
  for (int z = 0; z < grid.dims[2]; z += kBlock)
    for (int y = 0; y < grid.dims[1]; y += kBlock)
      for (int x = 0; x < grid.dims[0]; x += kBlock) {
        const double middle = field(grid.Position(x, y, z) +
                                    Eigen::Vector3d::Constant((kBlock - 1) / 2.0 * grid.spacing));
        const std::array<int, 3> end = {std::min(x + kBlock, grid.dims[0]),
                                        std::min(y + kBlock, grid.dims[1]),
                                        std::min(z + kBlock, grid.dims[2])};
        for (int k = z; k < end[2]; ++k)
          for (int j = y; j < end[1]; ++j)
            for (int i = x; i < end[0]; ++i)
              grid.values[grid.Index(i, j, k)] =
                  std::abs(middle) > enough ? middle : field(grid.Position(i, j, k));
      }
  return grid;
}

// Triangles grow with the square of the resolution: one coarse mesh tells how many there will be.
int ResolutionFor(const Recipe& recipe, const Box3& bounds, const std::string& label) {
  constexpr int kCoarse = 40, kFinest = 160;
  const std::size_t coarse =
      ExtractLevelSet(FilledGrid(recipe.field, bounds, kCoarse), 0).triangles.size();
  if (coarse == 0) Fail("{}: expected a closed shell, found nothing thicker than a voxel", label);
  const double factor = std::sqrt(recipe.triangles / static_cast<double>(coarse));
  return std::clamp(static_cast<int>(kCoarse * factor), 16, kFinest);
}

// The mesh without crumbs, pieces and bubbles that cuts leave in passing. What is larger tells the
// author where the stray piece (or the bubble inside) is.
TriMesh OneShellOf(const TriMesh& mesh, const std::string& label) {
  constexpr double kCrumb = 1e-3;  // of the largest shell's volume
  const std::vector<int> shell = ShellOfTriangles(mesh);
  if (shell.empty()) Fail("{}: expected one closed shell, found none", label);
  std::vector<std::vector<int>> members(*std::max_element(shell.begin(), shell.end()) + 1);
  for (std::size_t t = 0; t < shell.size(); ++t) members[shell[t]].push_back(static_cast<int>(t));
  std::sort(members.begin(), members.end(),
            [](const auto& a, const auto& b) { return a.size() > b.size(); });
  TriMesh largest = Submesh(mesh, members[0]);
  const double crumb = kCrumb * MassPropertiesOf(largest).volume;
  for (std::size_t i = 1; i < members.size(); ++i) {
    const TriMesh stray = Submesh(mesh, members[i]);
    const double volume = MassPropertiesOf(stray).volume;
    const Eigen::Vector3d at = BoundsOf(stray).Center();
    if (std::abs(volume) > crumb)
      Fail("{}: expected one closed shell, found {}; one is a {} at ({:.2f}, {:.2f}, {:.2f})",
           label, members.size(), volume > 0 ? "piece" : "bubble", at.x(), at.y(), at.z());
  }
  return largest;
}

}  // namespace

TriMesh MeshOfRecipe(const Recipe& recipe, double length, const std::string& label) {
  Box3 bounds;
  ExtendBounds(recipe.field, Eigen::Vector3d::Zero(), kReach, kReach / 256, bounds);
  if (!(bounds.Size().maxCoeff() > 0))
    Fail("{}: expected a shape within {} units of the origin, found nothing", label, kReach);
  const int resolution =
      recipe.resolution > 0 ? recipe.resolution : ResolutionFor(recipe, bounds, label);
  const DistanceGrid grid = FilledGrid(recipe.field, bounds, resolution);
  TriMesh mesh = OneShellOf(ExtractLevelSet(grid, 0), label);
  for (int round = 0; round < 2; ++round) {
    SmoothTangentially(2, mesh);
    ProjectToField(recipe.field, grid.spacing / 4, grid.spacing / 2, mesh);
  }
  const Box3 box = BoundsOf(mesh);
  const double factor = length / box.Size().maxCoeff();
  for (Eigen::Vector3d& v : mesh.vertices) v = factor * (v - box.Center());
  return mesh;
}

std::vector<RecipeObject> FindRecipes(const std::string& folder) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(folder)) Fail("{}: expected a folder of recipes, found none", folder);
  std::vector<RecipeObject> objects;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().extension() != ".recipe") continue;
    const std::string path = entry.path().string();
    RecipeHead head = ReadRecipeHead(path, ReadFile(path));
    if (head.variants.empty()) head.variants = {entry.path().stem().string()};
    for (const std::string& name : head.variants)
      objects.push_back(
          {path, entry.path().parent_path().filename().string(), name, head.object_class});
  }
  if (objects.empty()) Fail("{}: expected CATEGORY/NAME.recipe files, found none", folder);
  const auto key = [](const RecipeObject& o) { return std::tie(o.category, o.name, o.path); };
  std::sort(objects.begin(), objects.end(),
            [&](const RecipeObject& a, const RecipeObject& b) { return key(a) < key(b); });
  for (std::size_t i = 1; i < objects.size(); ++i)
    if (objects[i].category == objects[i - 1].category && objects[i].name == objects[i - 1].name)
      Fail("{}: expected names that differ within a category, found '{}' in {} too",
           objects[i].path, objects[i].name, objects[i - 1].path);
  return objects;
}

Recipe LoadRecipe(const RecipeObject& object, std::uint64_t seed) {
  std::uint64_t name = 0xCBF29CE484222325u;  // FNV-1a
  for (const char c : object.category + "/" + object.name)
    name = (name ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return ParseRecipe(object.path, ReadFile(object.path), SeedOf(seed, Stream::kRecipe, {name}),
                     object.name);
}

}  // namespace dexremoe
