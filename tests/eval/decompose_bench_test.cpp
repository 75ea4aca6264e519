// The measurements behind bench_decompose.
#include "eval/decompose_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "hand/primitive_mesh.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

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

// A folder with one ball, and a shell script in place of the program that decomposes by libHACD.
class Peer : public testing::Test {
 protected:
  Peer() : folder_(fs::temp_directory_path() / fmt::format("dexremoe it's a peer {}", getpid())) {
    fs::create_directories(folder_ / "balls" / "shoe");
    SaveMesh(Meshes() + "/shoe/ball.ply", SphereMesh(0.05));
    options_.peer = folder_ / "peer.sh";
  }
  ~Peer() override { fs::remove_all(folder_); }

  std::string Meshes() const { return folder_ / "balls"; }
  void Script(const std::string& text) {
    std::ofstream(options_.peer) << "#!/bin/sh\n" << text << "\n";
    fs::permissions(options_.peer, fs::perms::owner_all);
  }
  std::vector<DecomposedMesh> Run() {
    ThreadPool pool(1);
    return BenchPeerFolder(Meshes(), options_, pool);
  }

  fs::path folder_;
  DecomposeBenchOptions options_;
};

TEST_F(Peer, IsAskedForPartsOfTheSameMeshAndTellsItsOwnTime) {
  ObjectParts parts;
  parts.parts = {SphereMesh(0.05)};
  WriteParts(folder_ / "parts.h5", parts, {});
  Script(
      "[ -f \"${1#--mesh=}\" ] && cp \"$(dirname \"$0\")/parts.h5\" \"${2#--out=}\" && echo 1.5");
  const auto meshes = Run();
  ASSERT_EQ(meshes.size(), 1u);
  EXPECT_EQ(meshes[0].set, "balls, libHACD");
  EXPECT_EQ(meshes[0].seconds, 1.5);
  EXPECT_EQ(meshes[0].parts, 1);
}

TEST_F(Peer, ThatFailsIsNamed) {
  Script("exit 7");
  EXPECT_THAT([&] { Run(); }, ThrowsMessage<Error>(HasSubstr("peer.sh: expected success")));
}

}  // namespace
}  // namespace dexremoe
