// Object lists, grasps and the choice of objects.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "base/error.h"
#include "io/atomic_file.h"
#include "shape/cloud.h"
#include "task/grasp_file.h"
#include "task/object_choice.h"
#include "task_fixture.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

std::string TestPath(const std::string& name) {
  return (fs::temp_directory_path() / ("dexremoe_task_" + name)).string();
}

template <typename Body>
std::string Complaint(Body&& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ObjectList, ReadsBackWhatWasWritten) {
  const std::vector<ObjectEntry> entries = {
      {"duck", "animal", "train", "m/duck.ply", "d/duck", "d/duck/grasps.h5", "bird"},
      {"a_car", "vehicle", "ood", "m/a, car.ply", "d/a_car", "g.h5"}};
  WriteObjectList(TestPath("list.csv"), entries);
  const auto read = ReadObjectList(TestPath("list.csv"));
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].mesh, "m/a, car.ply");
  EXPECT_EQ(read[1].split, "ood");
  EXPECT_EQ(read[0].grasps, "d/duck/grasps.h5");
  EXPECT_EQ(read[0].object_class, "bird");
  EXPECT_EQ(read[1].object_class, "");
}

TEST(ObjectList, TheClassMayBeMissing) {
  WriteFile(TestPath("old.csv"),
            "name,category,split,mesh,folder,grasps\na,head,ood,a.ply,d/a,g.h5\n");
  const auto read = ReadObjectList(TestPath("old.csv"));
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].object_class, "");
  EXPECT_EQ(read[0].mesh, "a.ply");
}

TEST(ObjectList, BadLinesAreNamed) {
  const std::string head = "name,category,split,mesh,folder,grasps\n", path = TestPath("bad.csv");
  const auto complaint = [&](const std::string& rows) {
    WriteFile(path, head + rows);
    return Complaint([&] { ReadObjectList(path); });
  };
  EXPECT_THAT(complaint("a,fish,train,m,f,g\n"), AllOf(HasSubstr(path), HasSubstr("fish")));
  EXPECT_THAT(complaint("a,head,test,m,f,g\n"),
              AllOf(HasSubstr("train or ood"), HasSubstr("test")));
  EXPECT_THAT(complaint("a,head,ood,m,f,g\na,head,ood,m,f,g\n"), HasSubstr("again"));
  EXPECT_THAT(complaint(""), HasSubstr("none"));
}

TEST(PointsFeature, HoldsTheFirstPointsOfACloudOnTheUnitSphere) {
  fs::create_directories(TestPath("cloud"));
  PointCloud cloud;  // its centroid is (1, 2, 3) m, its radius 0.5 m
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0.5, 0, 0), {-0.5, 0, 0}, {0, 0, 0.25}, {0, 0, -0.25}})
    cloud.points.push_back(p + Eigen::Vector3d(1, 2, 3));
  cloud.normals.assign(4, Eigen::Vector3d::UnitX());
  WriteCloud(TestPath("cloud") + "/cloud.h5", cloud, {"test", "", 1, {}});
  EXPECT_THAT(PointsFeature(TestPath("cloud"), 3),
              testing::Pointwise(testing::FloatNear(1e-5),
                                 {1.f, 0.f, 0.f, -1.f, 0.f, 0.f, 0.f, 0.f, 0.5f}));
  EXPECT_THAT(Complaint([] { PointsFeature(TestPath("cloud"), 5); }),
              AllOf(HasSubstr("cloud.h5"), HasSubstr("at least 5, found 4")));
}

TEST(Grasps, ReadBackWhatWasWrittenBitForBit) {
  GraspSet set{MakeTaskObject("duck", 7).grasps, 0.25};
  set.grasps[3].scale = 0.9;
  WriteGrasps(TestPath("grasps.h5"), set, {"test", "", 1, {}});
  const GraspSet read = ReadGrasps(TestPath("grasps.h5"));
  EXPECT_EQ(read.acceptance, 0.25);
  ASSERT_EQ(read.grasps.size(), 7u);
  for (int g = 0; g < 7; ++g) {
    EXPECT_EQ(read.grasps[g].q, set.grasps[g].q);
    EXPECT_EQ(read.grasps[g].target, set.grasps[g].target);
    EXPECT_EQ(read.grasps[g].X_WO.p, set.grasps[g].X_WO.p);
    EXPECT_EQ(read.grasps[g].X_WO.q.coeffs(), set.grasps[g].X_WO.q.coeffs());
    EXPECT_EQ(read.grasps[g].scale, set.grasps[g].scale);
  }
}

TEST(Grasps, ARotationThatIsNoneIsRefused) {
  GraspSet set{MakeTaskObject("duck", 2).grasps, 0.25};
  set.grasps[1].X_WO.q.coeffs() *= 2;
  WriteGrasps(TestPath("grasps.h5"), set, {"test", "", 1, {}});
  EXPECT_THAT(Complaint([] { ReadGrasps(TestPath("grasps.h5")); }),
              AllOf(HasSubstr("object_rotation"), HasSubstr("row 1")));
}

std::vector<MeshFile> ManyMeshes(int per_category) {
  std::vector<MeshFile> meshes;
  for (const char* category : kCategories)
    for (int i = 0; i < per_category; ++i)
      meshes.push_back({category, fmt::format("m/{}/{}_{}.ply", category, category, i)});
  return meshes;
}

TEST(Choice, DrawsPerCategoryAndSplitsTheAskedFraction) {
  const auto entries = ChooseObjects(ManyMeshes(25), {0, 0.6667}, 1);
  EXPECT_EQ(entries.size(), 150u);
  EXPECT_EQ(std::count_if(entries.begin(), entries.end(),
                          [](const ObjectEntry& e) { return e.split == "ood"; }),
            50);
  EXPECT_EQ(ChooseObjects(ManyMeshes(25), {2, 0.6667}, 1).size(), 12u);
}

TEST(Choice, KeepsATrainingObjectOfEveryCategoryAndLeavesSomethingOut) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto entries = ChooseObjects(ManyMeshes(3), {2, 0.5}, seed);
    std::set<std::string> trained;
    int ood = 0;
    for (const ObjectEntry& e : entries)
      e.split == "train" ? void(trained.insert(e.category)) : void(++ood);
    EXPECT_EQ(trained.size(), 6u);
    EXPECT_EQ(ood, 6);
  }
}

TEST(Choice, DependsOnTheSeedAlone) {
  const auto names = [](std::uint64_t seed) {
    std::string all;
    for (const auto& e : ChooseObjects(ManyMeshes(10), {2, 0.667}, seed)) all += e.name + e.split;
    return all;
  };
  EXPECT_EQ(names(1), names(1));
  EXPECT_NE(names(1), names(2));
}

TEST(Choice, NamesAreUniqueAndFitForMake) {
  const auto entries =
      ChooseObjects({{"animal", "a/My Cat-1.ply"}, {"head", "h/my cat-1.ply"}}, {}, 1);
  EXPECT_EQ(entries[0].name, "animal_my_cat_1");
  EXPECT_EQ(entries[1].name, "head_my_cat_1");
  EXPECT_THAT(Complaint([&] { MakefileText(entries); }), HasSubstr("My Cat-1.ply"));
  const auto good = ChooseObjects({{"animal", "a/cat.ply"}}, {}, 1);
  EXPECT_EQ(MakefileText(good),
            "OBJECT_NAMES += cat\nMESH_cat := a/cat.ply\nCATEGORY_cat := animal\n");
}

TEST(ListMeshes, TakesTheManifestElseTheCategoryFolders) {
  const fs::path folder = TestPath("meshes");
  fs::remove_all(folder);
  fs::create_directories(folder / "head");
  fs::create_directories(folder / "other");
  for (const char* file : {"head/a.PLY", "head/b.txt", "other/c.ply"})
    WriteFile((folder / file).string(), "x");
  auto meshes = ListMeshes(folder.string());
  ASSERT_EQ(meshes.size(), 1u);
  EXPECT_EQ(meshes[0].path, (folder / "head/a.PLY").string());
  WriteFile((folder / "manifest.csv").string(), "category,file\nshoe,other/c.ply\n");
  meshes = ListMeshes(folder.string());
  ASSERT_EQ(meshes.size(), 1u);
  EXPECT_EQ(meshes[0].category, "shoe");
  EXPECT_EQ(meshes[0].object_class, "");
  WriteFile((folder / "manifest.csv").string(), "category,class,file\nshoe,boot,other/c.ply\n");
  const auto entries = ChooseObjects(ListMeshes(folder.string()), {}, 1);
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].object_class, "boot");
  WriteFile((folder / "manifest.csv").string(), "category,file\nshoe,gone.ply\n");
  EXPECT_THAT(Complaint([&] { ListMeshes(folder.string()); }), HasSubstr("gone.ply"));
  EXPECT_THAT(Complaint([&] { ListMeshes((folder / "none").string()); }), HasSubstr("folder"));
}

}  // namespace
}  // namespace dexremoe
