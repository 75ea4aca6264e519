// Contact sheets and pictures of single files.
#include "render/gallery.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "io/atomic_file.h"
#include "shape/cloud.h"
#include "test_meshes.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

std::vector<ObjectEntry> Entries(int animals, int heads) {
  std::vector<ObjectEntry> entries;
  for (int i = 0; i < animals + heads; ++i) {
    ObjectEntry& entry = entries.emplace_back();
    entry.name = "object_" + std::to_string(i);
    entry.category = i < animals ? "animal" : "head";
  }
  return entries;
}

TEST(PagesOf, EveryObjectStandsOnOnePageOfItsCategory) {
  const auto pages = PagesOf(Entries(7, 3), 3);
  ASSERT_EQ(pages.size(), 4u);
  EXPECT_EQ(pages[0].name, "animal");
  EXPECT_EQ(pages[1].name, "animal_2");
  EXPECT_EQ(pages[2].name, "animal_3");
  EXPECT_EQ(pages[3].name, "head");
  int next = 0;
  for (const GalleryPage& page : pages) {
    EXPECT_EQ(page.first, next);
    next += page.count;
  }
  EXPECT_EQ(next, 10);
  EXPECT_EQ(pages[2].count, 1);
}

class Gallery : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    ObjectMesh object;
    object.mesh = BallOf(0.04, 16);
    object.mass = object.volume = 1;
    object.name = "ball";
    object.category = "head";
    WriteObjectMesh(folder_ + "/mesh.h5", object, {"test", "", 1, {}});
    WriteParts(folder_ + "/parts.h5", {{BallOf(0.02, 12), CubeOf(0.02)}, 1, 0.1},
               {"test", "", 1, {}});
    CloudOptions options;
    options.points = 200;
    WriteCloud(folder_ + "/cloud.h5", SampleCloud(object.mesh, options, 1), {"test", "", 1, {}});
    SaveMesh(folder_ + "/ball.obj", object.mesh);
  }
  void TearDown() override { fs::remove_all(folder_); }
  // How many pixels are not paper.
  static int Drawn(const Image& image) {
    int drawn = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) drawn += image.at(x, y)[2] < 200;
    return drawn;
  }
  std::string folder_ = testing::TempDir() + "/dexremoe_gallery";
};

TEST_F(Gallery, EveryKindOfFileIsDrawnAlone) {
  Renderer renderer{RenderOptions()};
  for (const char* name : {"ball.obj", "mesh.h5", "parts.h5", "cloud.h5"}) {
    const SheetObject object = ReadSheetFile(folder_ + "/" + name, "z");
    EXPECT_GT(Drawn(ObjectPicture(renderer, object, 0.25, 96, 96)), 500) << name;
  }
  WriteFile(folder_ + "/other.h5", "no file of ours");
  EXPECT_THROW(ReadSheetFile(folder_ + "/other.h5", "z"), Error);
}

TEST_F(Gallery, HoldsAPageOfObjectsPartsAndCloudsAndListsThem) {
  Renderer renderer{RenderOptions()};
  const Fonts fonts;
  std::vector<ObjectEntry> entries = Entries(1, 1);
  for (ObjectEntry& entry : entries) entry.folder = folder_;
  SheetOptions options;
  options.width = 200;
  std::vector<int> done;
  DrawGallery(renderer, fonts, entries, options, folder_ + "/gallery",
              [&](int count, const std::string&) { done.push_back(count); });
  EXPECT_EQ(done, (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(ReadFile(folder_ + "/gallery/index.txt"),
            "objects_animal.png\nobjects_head.png\nparts_animal.png\nparts_head.png\n"
            "clouds_animal.png\nclouds_head.png\n");
  for (const char* name : {"objects_animal", "parts_head", "clouds_head"})
    EXPECT_TRUE(fs::exists(folder_ + "/gallery/" + name + ".png")) << name;
}

TEST(BeadsOf, StandAtTheirPointsAndAreClosed) {
  const TriMesh beads = BeadsOf({{1, 2, 3}, {4, 5, 6}}, 0.5);
  EXPECT_EQ(beads.triangles.size(), 16u);
  const MassProperties mass = MassPropertiesOf(beads);
  EXPECT_NEAR(mass.volume, 2 * 4.0 / 3 * 0.125, 1e-12);  // outward
  EXPECT_NEAR((mass.center - Eigen::Vector3d(2.5, 3.5, 4.5)).norm(), 0, 1e-9);
}

}  // namespace
}  // namespace dexremoe
