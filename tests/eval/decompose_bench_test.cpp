// The measurements behind bench_decompose.
#include "eval/decompose_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"

namespace dexremoe {
namespace {

using testing::HasSubstr;

DecomposedMesh Measured(const std::string& set, double ratio) {
  DecomposedMesh mesh;
  mesh.set = set;
  mesh.name = "a,b";
  mesh.voxel = 0.001;
  mesh.quality.volume_ratio = ratio;
  mesh.quality.stick_out = {0.002, 0.0035, 0.001};
  return mesh;
}

TEST(DecomposeBench, SummarisesEachSetByMedianAndSpread) {
  std::vector<DecomposedMesh> meshes;
  for (int i = 0; i <= 10; ++i) meshes.push_back(Measured("one", 1 + 0.1 * i));
  meshes.push_back(Measured("two", 3));
  const std::string text = DecomposeMarkdown(meshes, {});
  EXPECT_THAT(text, HasSubstr("1.50 [1.10, 1.90]"));
  EXPECT_THAT(text, HasSubstr("3.00 [3.00, 3.00]"));
  EXPECT_THAT(text, HasSubstr("3.5 [3.5, 3.5]"));  // voxels, of the worst part
  EXPECT_THAT(text, HasSubstr("V-HACD 4.1 (quoted)"));
}

TEST(DecomposeBench, ListsEveryMeshAsCsv) {
  EXPECT_THAT(DecomposeCsv({Measured("one", 1.25)}),
              HasSubstr("one,\"a,b\",0,0,0.00000,0.000,0.000,0,1.2500"));
}

TEST(DecomposeBench, RefusesAFolderWithoutMeshes) {
  ThreadPool pool(1);
  EXPECT_THROW(BenchFolder("tests/eval", {}, pool), Error);
}

}  // namespace
}  // namespace dexremoe
