// Hand descriptions made for the purpose: merging, shapes, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "hand/hand_model.h"
#include "hand/primitive_mesh.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string TestPath(const std::string& name) {
  return (std::filesystem::temp_directory_path() / ("dexremoe_urdf_" + name)).string();
}

std::string Inertial(double mass, const std::string& xyz = "0 0 0") {
  return fmt::format(
      "<inertial><origin xyz='{}'/><mass value='{}'/>"
      "<inertia ixx='1e-5' iyy='2e-5' izz='3e-5' ixy='0' ixz='0' iyz='0'/></inertial>",
      xyz, mass);
}

const std::string kLimit = "<limit lower='-1' upper='1' effort='1' velocity='2'/>";

std::string JointText(const std::string& name, const std::string& parent, const std::string& child,
                      const std::string& inside, const std::string& type = "revolute") {
  return fmt::format(
      "<joint name='{}' type='{}'><parent link='{}'/><child link='{}'/>"
      "<origin xyz='0.1 0 0'/>{}</joint>",
      name, type, parent, child, inside);
}

std::string LinkText(const std::string& name, const std::string& inside) {
  return fmt::format("<link name='{}'>{}</link>", name, inside);
}

HandModel Load(const std::string& name, const std::string& inside) {
  HandOptions options;
  options.urdf = TestPath(name + ".urdf");
  WriteFile(options.urdf, "<robot name='test'>" + inside + "</robot>");
  return LoadHand(options);
}

// The one line that Load fails with.
std::string Complaint(const std::string& name, const std::string& inside) {
  try {
    Load(name, inside);
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr(name + ".urdf"), Not(HasSubstr("\n"))));
    return error.what();
  }
  ADD_FAILURE() << name << ": was accepted";
  return "";
}

const std::string kAxisZ = "<axis xyz='0 0 1'/>" + kLimit;
const std::string kBase = LinkText("base", "");
const std::string kFinger = LinkText("a", Inertial(0.1)) + JointText("j", "base", "a", kAxisZ);

TEST(Urdf, FixedLinksMergeByParallelAxes) {
  const HandModel hand = Load("merge", kBase + kFinger + LinkText("tip", Inertial(0.3, "0 0.2 0")) +
                                           JointText("f", "a", "tip", "", "fixed"));
  ASSERT_EQ(hand.links.size(), 2u);
  const Link& link = hand.links[1];
  EXPECT_DOUBLE_EQ(link.mass, 0.4);
  EXPECT_LT((link.com - 0.75 * Vector3d(0.1, 0.2, 0)).norm(), 1e-15);
  // Two bodies: reduced mass times squared distance, plus their own.
  const double reduced = 0.1 * 0.3 / 0.4;
  EXPECT_NEAR(link.inertia(0, 0), reduced * 0.04 + 2e-5, 1e-15);
  EXPECT_NEAR(link.inertia(1, 1), reduced * 0.01 + 4e-5, 1e-15);
  EXPECT_NEAR(link.inertia(2, 2), reduced * 0.05 + 6e-5, 1e-15);
  EXPECT_NEAR(link.inertia(0, 1), -reduced * 0.02, 1e-15);
  EXPECT_LT((hand.tip_frames[0].p - Vector3d(0.1, 0, 0)).norm(), 1e-15);
}

TEST(Urdf, FingersAreOrderedByTheNumbersInTheirJointsNames) {
  const HandModel hand =
      Load("order", kBase + LinkText("x", Inertial(0.1)) + LinkText("y", Inertial(0.1)) +
                        JointText("joint10", "base", "x", kAxisZ) +
                        JointText("joint9", "base", "y", kAxisZ));
  EXPECT_EQ(hand.joints[0].name, "joint9");
  EXPECT_EQ(hand.joints[1].name, "joint10");
}

TEST(Urdf, ShapesBecomeColliders) {
  const auto shape = [](const std::string& name, const std::string& geometry) {
    return "<collision name='" + name + "'><geometry>" + geometry + "</geometry></collision>";
  };
  const HandModel hand =
      Load("shapes",
           LinkText("base", shape("b", "<box size='0.1 0.2 0.3'/>")) +
               LinkText("a", Inertial(0.1) + shape("s", "<sphere radius='0.01'/>") +
                                 shape("a_capsule", "<cylinder radius='0.01' length='0.04'/>") +
                                 shape("c", "<cylinder radius='0.01' length='0.04'/>")) +
               JointText("j", "base", "a", kAxisZ));
  ASSERT_EQ(hand.colliders.size(), 4u);
  EXPECT_EQ(hand.colliders[0].half_size, Vector3d(0.05, 0.1, 0.15));
  EXPECT_FALSE(hand.colliders[0].fingertip);
  EXPECT_EQ(hand.colliders[1].shape, ColliderShape::kSphere);
  EXPECT_TRUE(hand.colliders[1].fingertip);
  EXPECT_EQ(hand.colliders[2].shape, ColliderShape::kCapsule);
  EXPECT_DOUBLE_EQ(hand.colliders[2].half_length, 0.02);
  EXPECT_EQ(hand.colliders[3].shape, ColliderShape::kHull);
  EXPECT_LE(hand.colliders[3].hull.vertices.size(), 32u);
  EXPECT_NEAR(MassPropertiesOf(hand.colliders[3].hull).volume, 3.14159 * 1e-4 * 0.04, 1.5e-6);
}

TEST(Urdf, PackageMeshesAreFoundBesideTheDescription) {
  const std::string mesh =
      "<visual><geometry><mesh filename='package://some_hand/meshes/"
      "fingertip.obj' scale='2 2 2'/></geometry></visual>";
  HandOptions options;
  options.urdf = TestPath("package/urdf/hand.urdf");
  std::filesystem::create_directories(TestPath("package/meshes"));
  WriteFile(TestPath("package/meshes/fingertip.obj"), ReadFile("data/hand/meshes/fingertip.obj"));
  WriteFile(options.urdf, "<robot name='test'>" + LinkText("base", mesh) + kFinger + "</robot>");
  const HandModel hand = LoadHand(options);
  EXPECT_NEAR(BoundsOf(hand.links[0].visual).Size().x(), 0.068, 1e-4);
}

TEST(BadUrdf, SaysWhichLinkJointOrMeshIsWrong) {
  EXPECT_THAT(Complaint("no_child", kBase + JointText("j", "base", "a", kAxisZ)), HasSubstr("[a]"));
  EXPECT_THAT(Complaint("no_mesh", LinkText("base",
                                            "<collision><geometry><mesh filename='gone.stl'/>"
                                            "</geometry></collision>") +
                                       kFinger),
              AllOf(HasSubstr("base"), HasSubstr("gone.stl")));
  EXPECT_THAT(Complaint("still", kBase), HasSubstr("revolute"));
  EXPECT_THAT(Complaint("prismatic", kBase + LinkText("a", Inertial(1)) +
                                         JointText("j", "base", "a", kAxisZ, "prismatic")),
              HasSubstr("'j'"));
  EXPECT_THAT(Complaint("axis", kBase + LinkText("a", Inertial(1)) +
                                    JointText("j", "base", "a", "<axis xyz='0 0 2'/>" + kLimit)),
              AllOf(HasSubstr("'j'"), HasSubstr("unit vector"), HasSubstr("0 0 2")));
  EXPECT_THAT(
      Complaint("limits", kBase + LinkText("a", Inertial(1)) +
                              JointText("j", "base", "a",
                                        "<limit lower='2' upper='1' effort='1' velocity='1'/>")),
      AllOf(HasSubstr("'j'"), HasSubstr("lower < upper"), HasSubstr("2 and 1")));
  EXPECT_THAT(
      Complaint("mass", kBase + LinkText("a", Inertial(0)) + JointText("j", "base", "a", kAxisZ)),
      AllOf(HasSubstr("'a'"), HasSubstr("mass")));
  EXPECT_THAT(
      Complaint("no_inertial", kBase + LinkText("a", "") + JointText("j", "base", "a", kAxisZ)),
      HasSubstr("'a'"));
}

TEST(BadUrdf, LoopsAndBranchesAreRefused) {
  const std::string links = LinkText("a", Inertial(1)) + LinkText("b", Inertial(1));
  EXPECT_THAT(Complaint("two_parents", kBase + links + JointText("j", "base", "a", kAxisZ) +
                                           JointText("k", "base", "b", kAxisZ) +
                                           JointText("l", "a", "b", kAxisZ)),
              HasSubstr("loop"));
  EXPECT_THAT(
      Complaint("cycle", kBase + kFinger + LinkText("b", Inertial(1)) + LinkText("c", Inertial(1)) +
                             JointText("k", "b", "c", kAxisZ) + JointText("l", "c", "b", kAxisZ)),
      HasSubstr("loop"));
  EXPECT_THAT(Complaint("branch",
                        kBase + kFinger + LinkText("b", Inertial(1)) + LinkText("c", Inertial(1)) +
                            JointText("k", "a", "b", kAxisZ) + JointText("l", "a", "c", kAxisZ)),
              HasSubstr("serial"));
}

TEST(BadUrdf, NumbersAndTextThatAreNone) {
  EXPECT_THAT(Complaint("nan", kBase + LinkText("a", Inertial(1, "0 nan 0")) +
                                   JointText("j", "base", "a", kAxisZ)),
              Not(HasSubstr("\n")));
  EXPECT_THAT(Complaint("garbage", "<<<"), HasSubstr("URDF"));
  HandOptions options;
  options.urdf = TestPath("absent.urdf");
  EXPECT_THROW(LoadHand(options), Error);
}

TEST(PrimitiveMesh, VolumesApproachTheClosedForms) {
  const auto volume = [](const TriMesh& mesh) { return MassPropertiesOf(mesh).volume; };
  EXPECT_NEAR(volume(SphereMesh(1)), 4.18879, 0.08);
  EXPECT_NEAR(volume(CylinderMesh(1, 3, true)), 9.42478 + 4.18879, 0.15);
  EXPECT_NEAR(volume(CylinderMesh(0.1, 3, false)), 0.0942478, 0.002);
  const double box = volume(BoxMesh({1, 2, 3}));
  EXPECT_LT(box, 6);
  EXPECT_GT(box, 5.8);  // a bevel of 0.12
  EXPECT_EQ(BoundsOf(BoxMesh({1, 2, 3})).Size(), Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace dexremoe
