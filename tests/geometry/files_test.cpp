#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <limits>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "geometry/scale.h"
#include "io/atomic_file.h"
#include "shapes.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  Files() : folder_(fs::temp_directory_path() / fmt::format("dexremoe_geometry_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~Files() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  // The message of the Error that loading throws: one line that names the file.
  std::string LoadError(const std::string& name, const std::string& bytes) const {
    WriteFile(Path(name), bytes);
    try {
      LoadMesh(Path(name));
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(Path(name)), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      return message;
    }
    ADD_FAILURE() << name << ": loaded without an error";
    return {};
  }
  fs::path folder_;
};

TEST_F(Files, MeshesComeBackThroughEveryFormat) {
  const TriMesh mesh = ElbowMesh();
  for (const char* name : {"a.ply", "a.obj", "a.stl"}) {
    SaveMesh(Path(name), mesh);
    const TriMesh back = LoadMesh(Path(name));
    EXPECT_EQ(back.triangles.size(), mesh.triangles.size()) << name;
    EXPECT_EQ(back.vertices.size(), mesh.vertices.size()) << name;
    EXPECT_TRUE(TopologyOf(back).ClosedManifold()) << name;
    EXPECT_NEAR(MassPropertiesOf(back).volume / MassPropertiesOf(mesh).volume, 1, 1e-6) << name;
  }
  EXPECT_THROW(SaveMesh(Path("a.xyz"), mesh), Error);
}

TEST_F(Files, GroupsOfPartsLoadAsSeparateShells) {
  SaveParts(Path("p.obj"), {BoxMesh({0, 0, 0}, {1, 1, 1}), BoxMesh({2, 0, 0}, {3, 1, 1})});
  EXPECT_NE(ReadFile(Path("p.obj")).find("g part_01"), std::string::npos);
  EXPECT_EQ(TopologyOf(LoadMesh(Path("p.obj"))).shells, 2);
}

TEST_F(Files, NodeTransformsAreApplied) {
  // glTF with one triangle pair (a tetrahedron's worth is not needed), scaled by 2 and moved.
  const std::string positions(
      "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0", 36);
  WriteFile(Path("data.bin"), positions);
  WriteFile(Path("t.gltf"),
            R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
                "nodes":[{"mesh":0,"translation":[5,0,0],"scale":[2,2,2]}],
                "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
                "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
                              "min":[0,0,0],"max":[1,1,0]}],
                "bufferViews":[{"buffer":0,"byteLength":36}],
                "buffers":[{"uri":"data.bin","byteLength":36}]})");
  const Box3 box = BoundsOf(LoadMesh(Path("t.gltf")));
  EXPECT_LT((box.min - Eigen::Vector3d(5, 0, 0)).norm(), 1e-6);
  EXPECT_LT((box.max - Eigen::Vector3d(7, 2, 0)).norm(), 1e-6);
}

TEST_F(Files, BadMeshesGiveOneClearLine) {
  EXPECT_THROW(LoadMesh(Path("missing.ply")), Error);
  EXPECT_NE(LoadError("empty.stl", "").find("empty"), std::string::npos);
  EXPECT_NE(LoadError("a.txt", "hello").find("'.txt'"), std::string::npos);
  LoadError("noise.obj", "this is not a mesh\n");
  LoadError("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  EXPECT_NE(LoadError("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").find("finite"),
            std::string::npos);
  SaveMesh(Path("whole.ply"), SphereMesh(1, 8));
  SaveMesh(Path("whole.stl"), SphereMesh(1, 8));
  for (const char* kind : {".ply", ".stl"}) {
    const std::string whole = ReadFile(Path(std::string("whole") + kind));
    for (const double share : {0.3, 0.7, 0.98})
      LoadError(std::string("cut") + kind,
                whole.substr(0, static_cast<std::size_t>(share * whole.size())));
  }
}

TEST_F(Files, NoFacesInAPlyIsAnError) {
  LoadError("none.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
            "end_header\n0 0 0\n1 0 0\n0 1 0\n");
}

TEST_F(Files, PlyReadsTextPolygonsAndOtherElements) {
  WriteFile(Path("t.ply"),
            "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement vertex 4\r\n"
            "property float x\r\nproperty float y\r\nproperty float z\r\nproperty uchar red\r\n"
            "element face 1\r\nproperty list uchar int vertex_index\r\n"
            "element edge 1\r\nproperty int a\r\nend_header\r\n"
            "0 0 0 9\r\n1 0 0 9\r\n1 1 0 9\r\n0 1 0 9\r\n4 0 1 2 3\r\n7\r\n");
  const TriMesh mesh = LoadMesh(Path("t.ply"));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.vertices[2], Eigen::Vector3d(1, 1, 0));
}

TEST_F(Files, BinaryPlyMayStartWithALineEnd) {
  // 0x0a as the first data byte belongs to the first coordinate.
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\n"
      "property short z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  bytes += std::string("\x0a\x0d\0\0\0\0\0\1\0\0\0\0\0\0\0\1\0\0\3\0\1\2", 22);
  WriteFile(Path("t.ply"), bytes);
  EXPECT_EQ(LoadMesh(Path("t.ply")).vertices[0], Eigen::Vector3d(0x0a0d, 0, 0));
}

TEST_F(Files, BadPlyNamesTheField) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n";
  const std::string body =
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  const auto has = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(LoadError("a.ply", head + body + "3 0 1 5\n"), "indices in 0..2, found 5");
  has(LoadError("b.ply", head + body), "1 rows of 'face', found 0");
  has(LoadError("c.ply", head + body + "3 0 one 2\n"), "expected a number, found 'one'");
  has(LoadError("d.ply", "ply\nformat funny 1.0\n" + body), "found 'funny'");
  has(LoadError("e.ply", head + "property real q\n" + body), "found 'real'");
  has(LoadError("f.ply", "ply\nformat ascii 1.0\n"), "end_header");
  has(LoadError("g.ply", "polygon\n"), "first line 'ply'");
}

ObjectMesh SampleObject() {
  ObjectMesh object = MakeObject(ElbowMesh(), {}, "elbow");
  object.name = "elbow";
  object.category = "vehicle";
  return object;
}

TEST_F(Files, ObjectsComeBackBitForBit) {
  const ObjectMesh object = SampleObject();
  const Provenance provenance = {"test", "", 0, {}};
  WriteObjectMesh(Path("mesh.h5"), object, provenance);
  WriteObjectMesh(Path("again.h5"), object, provenance);
  EXPECT_EQ(ReadFile(Path("mesh.h5")), ReadFile(Path("again.h5")));
  const ObjectMesh back = ReadObjectMesh(Path("mesh.h5"));
  EXPECT_EQ(back.mesh.vertices, object.mesh.vertices);
  EXPECT_EQ(back.mesh.triangles, object.mesh.triangles);
  EXPECT_EQ(back.mass, object.mass);
  EXPECT_EQ(back.volume, object.volume);
  EXPECT_EQ(back.inertia, object.inertia);
  EXPECT_EQ(back.source_to_object, object.source_to_object);
  EXPECT_EQ(back.name, "elbow");
  EXPECT_EQ(back.category, "vehicle");
  EXPECT_EQ(back.repair, "closed as it was");
}

TEST_F(Files, PartsComeBackBitForBit) {
  const ObjectParts parts = {.parts = {BoxMesh({0, 0, 0}, {1, 1, 1}), SphereMesh(1, 4)},
                             .volume_ratio = 1.25,
                             .hausdorff_ratio = 0.015,
                             .stick_out = {0.002, 0}};
  WriteParts(Path("parts.h5"), parts, {"test", "", 0, {}});
  const ObjectParts back = ReadParts(Path("parts.h5"));
  ASSERT_EQ(back.parts.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(back.parts[i].vertices, parts.parts[i].vertices);
    EXPECT_EQ(back.parts[i].triangles, parts.parts[i].triangles);
  }
  EXPECT_EQ(back.volume_ratio, 1.25);
  EXPECT_EQ(back.hausdorff_ratio, 0.015);
  EXPECT_EQ(back.stick_out, parts.stick_out);
  EXPECT_THROW(ReadObjectMesh(Path("parts.h5")), Error);  // another format
}

TEST(MakeObject, IsCentredScaledAndConsistent) {
  ScaleOptions options;
  const ObjectMesh object = MakeObject(ElbowMesh(), options, "elbow");
  EXPECT_NEAR(BoundsOf(object.mesh).Size().maxCoeff(), 0.08, 1e-12);
  const MassProperties p = MassPropertiesOf(object.mesh);
  EXPECT_LT(p.center.norm(), 1e-12);
  EXPECT_NEAR(object.volume, p.volume, 1e-15);
  EXPECT_LT((object.inertia - 0.08 / p.volume * p.inertia).norm(), 1e-15);
  const Eigen::Vector4d corner = object.source_to_object * ElbowMesh().vertices[0].homogeneous();
  EXPECT_LT((corner.head<3>() - object.mesh.vertices[0]).norm(), 1e-12);
}

}  // namespace
}  // namespace dexremoe
