// Malformed and hostile mesh files: each is repaired as stated or refused in one clear line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "base/random.h"
#include "geometry/mesh_io.h"
#include "geometry/scale.h"
#include "io/atomic_file.h"
#include "shapes.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// What becomes of a file: "repaired: ..." or "refused: ...". Checks what holds for every file.
std::string VerdictOn(const std::string& path, const ScaleOptions& options = {}) {
  try {
    const ObjectMesh object = MakeObject(LoadMesh(path), options, path);
    EXPECT_TRUE(TopologyOf(object.mesh).ClosedManifold()) << path;
    EXPECT_EQ(TopologyOf(object.mesh).shells, 1) << path;
    EXPECT_GT(object.volume, 0) << path;
    EXPECT_LE(BoundsOf(object.mesh).Size().maxCoeff(), 1.15 * options.length * options.scale)
        << path;
    return "repaired: " + object.repair;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find(path), std::string::npos) << message;
    return "refused: " + message;
  }
}

class HostileMesh : public testing::Test {
 protected:
  HostileMesh()
      : folder_(fs::temp_directory_path() / fmt::format("dexremoe_hostile_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~HostileMesh() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Verdict(const std::string& name, const std::string& bytes) const {
    WriteFile(Path(name), bytes);
    return VerdictOn(Path(name));
  }
  std::string Verdict(const std::string& name, const TriMesh& mesh,
                      const ScaleOptions& options = {}) const {
    SaveMesh(Path(name), mesh);
    return VerdictOn(Path(name), options);
  }
  std::string Bytes(const std::string& name, const TriMesh& mesh) const {
    SaveMesh(Path(name), mesh);
    return ReadFile(Path(name));
  }
  fs::path folder_;
};

TriMesh UnitBox() { return BoxMesh({0, 0, 0}, {1, 1, 1}); }

// A closed tube along 1.2 turns of a flat spiral, so narrow that its ends run into each other.
TriMesh Spiral() {
  constexpr int kAlong = 60, kRound = 16;
  TriMesh mesh;
  const auto center = [](int i) {
    const double turn = 2.4 * std::numbers::pi * i / kAlong, radius = 1 + 0.02 * turn;
    return Eigen::Vector3d(radius * std::cos(turn), radius * std::sin(turn), 0);
  };
  for (int i = 0; i <= kAlong; ++i)
    for (int j = 0; j < kRound; ++j) {
      const double around = 2 * std::numbers::pi * j / kRound;
      mesh.vertices.push_back(center(i) + 0.3 * std::cos(around) * center(i).normalized() +
                              0.3 * std::sin(around) * Eigen::Vector3d::UnitZ());
    }
  mesh.vertices.push_back(center(0));
  mesh.vertices.push_back(center(kAlong));
  const int first = kAlong * kRound, low_cap = first + kRound, high_cap = low_cap + 1;
  for (int j = 0; j < kRound; ++j) {
    const int next = (j + 1) % kRound;
    mesh.triangles.push_back({low_cap, j, next});
    mesh.triangles.push_back({high_cap, first + next, first + j});
    for (int i = 0; i < kAlong; ++i) {
      const int here = i * kRound, there = here + kRound;
      mesh.triangles.push_back({here + j, there + j, there + next});
      mesh.triangles.push_back({here + j, there + next, here + next});
    }
  }
  return WithConsistentWinding(mesh);
}

TEST_F(HostileMesh, FilesThatHoldNoMeshAreRefused) {
  EXPECT_THAT(Verdict("empty.obj", std::string()), HasSubstr("found an empty file"));
  EXPECT_THAT(Verdict("mesh.txt", "v 0 0 0\n"), HasSubstr("expected a mesh file"));
  EXPECT_THAT(Verdict("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), StartsWith("refused"));
  EXPECT_THAT(VerdictOn(Path("absent.obj")), StartsWith("refused"));
  EXPECT_THAT(VerdictOn(folder_.string()), HasSubstr("found something else"));
  ASSERT_EQ(mkfifo(Path("pipe.obj").c_str(), 0600), 0);
  EXPECT_THAT(VerdictOn(Path("pipe.obj")), HasSubstr("found something else"));
}

TEST_F(HostileMesh, TruncatedFilesAreRefused) {
  const TriMesh mesh = SphereMesh(1, 8);
  for (const char* name : {"cut.stl", "cut.ply"}) {
    const std::string bytes = Bytes(name, mesh);
    EXPECT_THAT(Verdict(name, bytes.substr(0, bytes.size() / 2)), HasSubstr("truncated")) << name;
  }
  // Cut within the faces: vertices that faces name are all there, the rest is closed.
  const std::string text = Bytes("cut.obj", mesh);
  EXPECT_THAT(Verdict("cut.obj", text.substr(0, text.size() * 9 / 10)),
              StartsWith("repaired: remeshed: 1 shells"));
}

TEST_F(HostileMesh, NoiseIsRefused) {
  Rng rng(1, Stream::kTest);
  for (const char* name : {"noise.obj", "noise.stl", "noise.ply", "noise.off", "noise.dae",
                           "noise.fbx", "noise.gltf", "noise.glb", "noise.3ds", "noise.blend"}) {
    std::string bytes;
    for (int i = 0; i < 4096; ++i) bytes += static_cast<char>(rng.Index(256));
    EXPECT_THAT(Verdict(name, bytes), StartsWith("refused")) << name;
  }
}

TEST_F(HostileMesh, FlippedBytesNeverCrash) {
  Rng rng(2, Stream::kTest);
  for (const char* name : {"flip.obj", "flip.stl", "flip.ply"}) {
    const std::string good = Bytes(name, UnitBox());
    for (int round = 0; round < 20; ++round) {
      std::string bytes = good;
      for (int i = 0; i < 3; ++i)
        bytes[rng.Index(bytes.size())] = static_cast<char>(rng.Index(256));
      WriteFile(Path(name), bytes);
      ScaleOptions coarse;
      coarse.repair.resolution = 16;
      EXPECT_FALSE(VerdictOn(Path(name), coarse).empty());
    }
  }
}

TEST_F(HostileMesh, CoordinatesThatAreNoNumbersAreRefused) {
  const std::string face = "v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 2 4 3\nf 1 4 2\n";
  EXPECT_THAT(Verdict("nan.obj", "v nan 0 0\n" + face), HasSubstr("finite coordinates"));
  EXPECT_THAT(
      Verdict("nan.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
              "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
              "end_header\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"),
      HasSubstr("finite coordinates"));
}

TEST_F(HostileMesh, HeadersThatPromiseTooMuchAreRefused) {
  EXPECT_THAT(Verdict("rows.ply",
                      "ply\nformat ascii 1.0\nelement ghost 99999999999999\nelement face 1\n"
                      "property list uchar int vertex_indices\nend_header\n3 0 1 2\n"),
              HasSubstr("truncated"));
  EXPECT_THAT(Verdict("list.ply",
                      "ply\nformat ascii 1.0\nelement face 1\nproperty list double int "
                      "vertex_indices\nend_header\n1e300 0 1 2\n"),
              HasSubstr("truncated"));
  EXPECT_THAT(Verdict("many.off", "OFF\n2000000000 2000000000 0\n0 0 0\n"), StartsWith("refused"));
}

TEST_F(HostileMesh, SizeAndPlaceDoNotMatter) {
  for (const double size : {1e-20, 1e-6, 1e6, 1e20, 1e30})
    EXPECT_EQ(Verdict("size.obj", Transformed(UnitBox(), size * Eigen::Matrix3d::Identity(),
                                              Eigen::Vector3d::Constant(3 * size))),
              "repaired: closed as it was")
        << size;
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_THAT(Verdict("large.ply", start + "0 0 0\n1e200 0 0\n0 1e200 0\n3 0 1 2\n"),
              StartsWith("repaired: remeshed"));
  EXPECT_THAT(Verdict("far.ply", start + "0 0 0\n1e308 0 0\n-1e308 1 0\n3 0 1 2\n"),
              HasSubstr("finite extent"));
}

TEST_F(HostileMesh, WhatHasNoAreaIsRefused) {
  EXPECT_THAT(Verdict("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
              HasSubstr("faces with an area"));
  EXPECT_THAT(Verdict("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"), StartsWith("refused"));
  EXPECT_THAT(Verdict("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), StartsWith("refused"));
}

TEST_F(HostileMesh, AFlatSheetBecomesAPlateOfTheStatedThickness) {
  const std::string verdict =
      Verdict("sheet.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n");
  EXPECT_THAT(verdict, AllOf(StartsWith("repaired: remeshed"), HasSubstr("sheets to 2.2 %")));
  const ObjectMesh object = MakeObject(LoadMesh(Path("sheet.obj")), {}, "sheet");
  EXPECT_LE(BoundsOf(object.mesh).Size().minCoeff(), 0.0219 * 0.08);
  EXPECT_LE(object.source_distance, 0.0101 * 0.08 * std::sqrt(3.0));
  EXPECT_GT(object.source_distance, 0.008 * 0.08);
}

TEST_F(HostileMesh, ShellsAreMadeOne) {
  EXPECT_EQ(Verdict("twice.obj", Joined(UnitBox(), UnitBox())), "repaired: closed as it was");
  TriMesh inside_out = UnitBox();
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(Verdict("inside out.obj", inside_out), "repaired: closed; turned inside out");
  EXPECT_THAT(Verdict("edge.obj", Joined(UnitBox(), BoxMesh({1, 1, 0}, {2, 2, 1}))),
              HasSubstr("1 crowded edges"));
  EXPECT_THAT(Verdict("crossing.obj", Spiral()), HasSubstr("crosses itself"));
  EXPECT_THAT(Verdict("apart.obj", Joined(UnitBox(), BoxMesh({3, 0, 0}, {3.5, 0.5, 0.5}))),
              HasSubstr("dropped 1 separate pieces"));
}

TEST_F(HostileMesh, NamesMayHoldAnything) {
  for (const char* name : {"two words.obj", "a'b\"c$d.obj", "Flügel 飛行機 ✈.obj", "-x.stl"})
    EXPECT_EQ(Verdict(name, UnitBox()), "repaired: closed as it was") << name;
}

TEST_F(HostileMesh, AnotherFormatThanTheNameSaysIsRefusedOrRead) {
  const std::string stl = Bytes("true.stl", UnitBox()), obj = Bytes("true.obj", UnitBox());
  EXPECT_THAT(Verdict("stl.obj", stl), StartsWith("refused"));
  EXPECT_THAT(Verdict("stl.ply", stl), HasSubstr("expected a PLY header"));
  EXPECT_THAT(Verdict("obj.stl", obj), StartsWith("refused"));
}

TEST_F(HostileMesh, AMissingBufferIsRefused) {
  EXPECT_THAT(
      Verdict("lost.gltf",
              R"({"asset":{"version":"2.0"},"buffers":[{"uri":"absent.bin","byteLength":36}],
"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,
"count":3,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})"),
      HasSubstr("not a readable mesh"));
}

TEST_F(HostileMesh, LimitsAreKept) {
  SaveMesh(Path("ball.obj"), SphereMesh(1, 16));
  LoadLimits small_file, few_triangles;
  small_file.megabytes = 0.001;
  few_triangles.triangles = 100;
  EXPECT_THROW(LoadMesh(Path("ball.obj"), small_file), Error);
  EXPECT_THROW(LoadMesh(Path("ball.obj"), few_triangles), Error);
  ScaleOptions options;
  options.repair.max_closed = 500;
  EXPECT_THAT(Verdict("ball.obj", SphereMesh(1, 16), options), HasSubstr("960 triangles"));
}

TEST_F(HostileMesh, AMillionTrianglesAreRemeshedSlow) {
  EXPECT_THAT(Verdict("million.obj", SphereMesh(1, 500)), HasSubstr("998000 triangles"));
}

// The models that test assimp, those meant to break it included.
TEST(AssimpModels, EachIsRepairedOrRefusedSlow) {
  const char* given = std::getenv("DEX_ASSIMP_MODELS");
  const fs::path folder = given != nullptr ? given : "/usr/share/assimp/models";
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder << " (Debian package assimp-testmodels)";
  std::vector<std::string> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  ScaleOptions coarse;
  coarse.repair.resolution = 24;
  int repaired = 0;
  for (const std::string& path : paths) {
    const std::string verdict = VerdictOn(path, coarse);
    repaired += verdict.starts_with("repaired");
    std::printf("%s: %s\n", fs::relative(path, folder).c_str(), verdict.c_str());
    std::fflush(stdout);
  }
  std::printf("%d of %zu files repaired\n", repaired, paths.size());
  EXPECT_GT(repaired, 0);
}

}  // namespace
}  // namespace dexremoe
