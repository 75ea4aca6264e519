// Properties of the built-in object set, data/recipes.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "base/random.h"
#include "geometry/recipes.h"
#include "geometry/repair.h"
#include "geometry/triangle_bvh.h"

namespace dexremoe {
namespace {

constexpr double kLength = 0.1;  // longest side of every mesh, m
// Nearer than this share of the length on average, two shapes differ by less than what the convex
// parts of either leave out. The nearest two, runner and sneaker, are 0.007 apart.
constexpr double kTwins = 0.006;
constexpr int kNumPerCategory = 25;

class Builtin : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string folder = "data/recipes";
    if (!std::filesystem::is_directory(folder))
      GTEST_SKIP() << "run from the top of the project: " << folder << " not found";
    objects_ = FindRecipes(folder);
  }
  std::vector<RecipeObject> objects_;
};

void ExpectFitShell(const RecipeObject& object, const TriMesh& mesh) {
  const Topology topology = TopologyOf(mesh);
  const std::string label = object.category + "/" + object.name;
  EXPECT_TRUE(topology.ClosedManifold()) << label;
  EXPECT_EQ(topology.shells, 1) << label;
  EXPECT_GT(MassPropertiesOf(mesh).volume, 0) << label;  // wound outward
  EXPECT_GE(mesh.triangles.size(), 2000u) << label;
  EXPECT_LE(mesh.triangles.size(), 20000u) << label;
  EXPECT_NEAR(BoundsOf(mesh).Size().maxCoeff(), kLength, 1e-9) << label;
}

TriMesh MeshOf(const RecipeObject& object, std::uint64_t seed) {
  return MeshOfRecipe(LoadRecipe(object, seed), kLength, object.name);
}

// Values of the recipe's field at random places in and around the object.
std::vector<double> Probe(const RecipeObject& object, std::uint64_t seed) {
  const Field field = LoadRecipe(object, seed).field;
  Rng rng(7, Stream::kRecipe);
  std::vector<double> values;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p(rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(-1, 1));
    values.push_back(field(p));
  }
  return values;
}

// Mean distance of about 100 of a's vertices from the surface of b.
double MeanDistance(const TriMesh& a, const TriangleBvh& b) {
  const std::size_t step = a.vertices.size() / 100;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < a.vertices.size(); i += step, ++count)
    sum += b.Closest(a.vertices[i]).distance;
  return sum / count;
}

TEST_F(Builtin, EveryCategoryHasTwentyFiveObjectsOfSeveralClasses) {
  std::map<std::string, int> count;
  std::map<std::string, std::set<std::string>> classes;
  for (const RecipeObject& object : objects_) {
    ++count[object.category];
    EXPECT_NE(object.object_class, "") << object.path;
    classes[object.category].insert(object.object_class);
  }
  EXPECT_EQ(count.size(), 6u);
  for (const auto& [category, n] : count) {
    EXPECT_EQ(n, kNumPerCategory) << category;
    EXPECT_GE(classes[category].size(), 3u) << category;
  }
}

TEST_F(Builtin, EqualSeedsGiveEqualShapesAndOthersOtherOnes) {
  for (const RecipeObject& object : objects_) {
    const std::vector<double> first = Probe(object, 1);
    EXPECT_EQ(first, Probe(object, 1)) << object.path;
    EXPECT_TRUE(first != Probe(object, 2)) << object.path << ": " << object.name;
  }
}

TEST_F(Builtin, OneOfEachCategoryIsAClosedShellEqualBitForBitWhenRemade) {
  std::set<std::string> seen;
  for (const RecipeObject& object : objects_) {
    if (!seen.insert(object.category).second) continue;
    const TriMesh mesh = MeshOf(object, 1);
    ExpectFitShell(object, mesh);
    if (seen.size() > 1) continue;
    const TriMesh again = MeshOf(object, 1);
    EXPECT_EQ(mesh.vertices, again.vertices);
    EXPECT_EQ(mesh.triangles, again.triangles);
  }
}

TEST_F(Builtin, SlowAllAreClosedShellsOfFewTrianglesForSeveralSeeds) {
  for (const RecipeObject& object : objects_)
    for (const std::uint64_t seed : {1, 2, 3}) ExpectFitShell(object, MeshOf(object, seed));
}

TEST_F(Builtin, SlowNoTwoOfACategoryAreNearTwins) {
  std::map<std::string, std::vector<std::pair<std::string, TriMesh>>> meshes;
  for (const RecipeObject& object : objects_)
    meshes[object.category].emplace_back(object.name, MeshOf(object, 1));
  for (const auto& [category, members] : meshes) {
    std::vector<TriangleBvh> trees;
    for (const auto& [name, mesh] : members) trees.emplace_back(mesh);
    for (std::size_t a = 0; a < members.size(); ++a)
      for (std::size_t b = a + 1; b < members.size(); ++b) {
        const double apart = (MeanDistance(members[a].second, trees[b]) +
                              MeanDistance(members[b].second, trees[a])) /
                             (2 * kLength);
        EXPECT_GT(apart, kTwins) << category << ": " << members[a].first << " and "
                                 << members[b].first;
      }
  }
}

}  // namespace
}  // namespace dexremoe
