// The real inputs, where their place is given: DEX_REAL_MESHES (a folder of CATEGORY/NAME.ply) and
// DEX_REAL_HAND (a URDF with its meshes in ../meshes).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "geometry/decompose.h"
#include "geometry/mesh_io.h"
#include "geometry/scale.h"
#include "shapes.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> MeshesUnder(const fs::path& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".ply" || ending == ".STL" || ending == ".stl")
      paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

void ExpectGoodParts(const TriMesh& mesh, const DecomposeOptions& options,
                     const std::string& path) {
  const ConvexParts parts = DecomposeConvex(mesh, options, path);
  EXPECT_LE(static_cast<int>(parts.size()), options.parts) << path;
  for (const TriMesh& part : parts) {
    EXPECT_TRUE(TopologyOf(part).ClosedManifold()) << path;
    EXPECT_GT(MassPropertiesOf(part).volume, 0) << path;
    EXPECT_TRUE(IsConvex(part, 1e-9)) << path;
  }
  const DecompositionQuality quality = QualityOf(mesh, parts);
  EXPECT_GT(quality.volume_ratio, 0.8) << path;
  EXPECT_LT(quality.hausdorff_ratio, 0.15) << path;
}

TEST(RealMeshes, BecomeObjectsWithPartsSlow) {
  const char* folder = std::getenv("DEX_REAL_MESHES");
  if (folder == nullptr) GTEST_SKIP() << "DEX_REAL_MESHES is not set";
  const std::vector<std::string> paths = MeshesUnder(folder);
  ASSERT_FALSE(paths.empty());
  for (std::size_t i = 0; i < paths.size(); i += 12) {
    const ObjectMesh object = MakeObject(LoadMesh(paths[i]), {}, paths[i]);
    const Topology topology = TopologyOf(object.mesh);
    EXPECT_TRUE(topology.ClosedManifold()) << paths[i];
    EXPECT_EQ(topology.shells, 1) << paths[i];
    EXPECT_GT(object.volume, 0) << paths[i];
    ExpectGoodParts(object.mesh, {}, paths[i]);
  }
}

TEST(RealHand, LinksHaveFewPartsSlow) {
  const char* urdf = std::getenv("DEX_REAL_HAND");
  if (urdf == nullptr) GTEST_SKIP() << "DEX_REAL_HAND is not set";
  const auto paths = MeshesUnder(fs::path(urdf).parent_path().parent_path() / "meshes");
  ASSERT_FALSE(paths.empty());
  DecomposeOptions options;
  options.parts = 4;
  for (const std::string& path : paths) ExpectGoodParts(LoadMesh(path), options, path);
}

}  // namespace
}  // namespace dexremoe
