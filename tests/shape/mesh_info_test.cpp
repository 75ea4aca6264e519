// What mesh_info says of boxes whose numbers are known.
#include "shape/mesh_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "shape/cloud.h"
#include "shape/shape_files.h"
#include "shapes.h"

namespace dexremoe {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string TemporaryPath(const std::string& name) { return ::testing::TempDir() + name; }

TEST(MeshInfo, OfAMeshFileStatesCountsSizesAndThatItIsClosed) {
  const std::string path = TemporaryPath("box.obj");
  SaveMesh(path, BoxMesh({2, 3, 4}));
  EXPECT_THAT(DescribeMeshFile(path),
              AllOf(HasSubstr("triangles:     12 (8 vertices)\n"),
                    HasSubstr("box:           2 x 3 x 4 file units\n"),
                    HasSubstr("area:          52 file units^2\n"),
                    HasSubstr("volume:        24 file units^3\n"), HasSubstr("shells:        1\n"),
                    HasSubstr("closed:        yes\n")));
}

TEST(MeshInfo, OfAnOpenMeshCountsTheOpenEdgesAndKeepsQuietAboutTheVolume) {
  const std::string path = TemporaryPath("open_box.obj");
  TriMesh mesh = BoxMesh({2, 3, 4});
  mesh.triangles.pop_back();
  SaveMesh(path, mesh);
  EXPECT_THAT(DescribeMeshFile(path),
              AllOf(HasSubstr("closed:        no: 3 open, 0 crowded and 0 flipped edges"),
                    HasSubstr("volume:        unknown")));
}

TEST(MeshInfo, OfAnObjectItsPartsAndItsCloudIsInMillimetres) {
  ObjectMesh object;
  object.mesh = BoxMesh({0.02, 0.03, 0.04});
  object.volume = MassPropertiesOf(object.mesh).volume;
  object.mass = 0.048;
  object.name = "brick";
  object.category = "vehicle";
  object.repair = "closed as it was";
  WriteObjectMesh(TemporaryPath("mesh.h5"), object, {"test", "", 1, {}});
  EXPECT_THAT(
      DescribeMeshFile(TemporaryPath("mesh.h5")),
      AllOf(HasSubstr("name:          brick (vehicle)\n"),
            HasSubstr("box:           20 x 30 x 40 mm\n"), HasSubstr("volume:        24000 mm^3\n"),
            HasSubstr("mass:          0.048 kg (2000 kg/m^3)\n"),
            HasSubstr("repair:        closed as it was\n")));
  WriteParts(TemporaryPath("parts.h5"), {{object.mesh, object.mesh}, 2, 0.25}, {"test", "", 1, {}});
  EXPECT_THAT(DescribeMeshFile(TemporaryPath("parts.h5")),
              AllOf(HasSubstr("parts:         2 (8 to 8 vertices)\n"),
                    HasSubstr("volume:        48000 mm^3, summed\n"),
                    HasSubstr("volume ratio:  2.0000"), HasSubstr("hausdorff:     0.2500")));
  WriteCloud(TemporaryPath("cloud.h5"),
             {{{0, 0, 0}, {0.001, 0, 0}, {0.003, 0, 0}, {0.006, 0, 0}},
              std::vector<Eigen::Vector3d>(4, {0, 0, 1})},
             {"test", "", 1, {}});
  EXPECT_THAT(DescribeMeshFile(TemporaryPath("cloud.h5")),
              AllOf(HasSubstr("points:        4\n"), HasSubstr("box:           6 x 0 x 0 mm\n"),
                    HasSubstr("spacing:       2.000 mm at the median, 1.000 mm at least\n")));
}

TEST(MeshInfo, RefusesOtherFilesByName) {
  const std::string path = TemporaryPath("info_shape.h5");
  WriteShape(path, {std::vector<float>(100, 0.0f), std::vector<float>(6, 0.0f)},
             {"test", "", 1, {}});
  EXPECT_THAT([&] { DescribeMeshFile(path); },
              ThrowsMessage<Error>(AllOf(HasSubstr(path), HasSubstr("found dexremoe.shape"))));
  EXPECT_THROW(DescribeMeshFile(TemporaryPath("absent.ply")), Error);
}

}  // namespace
}  // namespace dexremoe
