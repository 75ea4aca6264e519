// What is special about the MuJoCo engine: that its model is our hand and object, and how it fails.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "scenes.h"
#include "sim/mujoco/mujoco_sim.h"

#if !__has_include(<mujoco/mujoco.h>)

namespace dexremoe {
namespace {

TEST(Mujoco, ABuildWithoutItSaysWhatToInstall) {
  ThreadPool pool(1);
  SimOptions options;
  options.engine = "mujoco";
  EXPECT_FALSE(MujocoAvailable());
  try {
    MakeBatchSim(options, scenes::PalmOnly(), {scenes::Cube()}, 1, pool);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("install libmujoco-dev"), std::string::npos);
  }
}

}  // namespace
}  // namespace dexremoe

#else

#include <cstdlib>
#include <filesystem>

#include "sim/mujoco/mujoco_scene.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using scenes::Rig;

constexpr int kReferee = 16;  // substeps of 1/60 s: 1 ms

SimOptions Options(int substeps) {
  SimOptions options;
  options.engine = "mujoco";
  options.substeps = substeps;
  return options;
}

Quaterniond QuaternionAt(const double* q) { return {q[0], q[1], q[2], q[3]}; }

// About the centre of mass, in the body's axes.
Matrix3d InertiaOf(const mjModel& model, int body) {
  const Matrix3d R = QuaternionAt(model.body_iquat + 4 * body).toRotationMatrix();
  return R * Vector3d(model.body_inertia + 3 * body).asDiagonal() * R.transpose();
}

int IdOf(const mjModel& model, mjtObj type, const std::string& name) {
  return mj_name2id(&model, type, name.c_str());
}

// A tetrahedron of no symmetry, off the origin, with principal axes along no axis of O.
SimObject Wedge() {
  SimObject object;
  object.name = "wedge";
  TriMesh mesh;
  mesh.vertices = {{.03, .01, -.01}, {-.02, .025, 0}, {-.015, -.02, -.005}, {.01, 0, .03}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  object.parts = {mesh};
  const Matrix3d R = Quaterniond(0.9, 0.1, -0.3, 0.2).normalized().toRotationMatrix();
  object.unit_inertia = R * Vector3d(2e-4, 3e-4, 4e-4).asDiagonal() * R.transpose();
  object.radius = 0.034;
  return object;
}

// The scene and its model with all numbers of a random configuration worked out.
struct Posed {
  Posed(const HandModel& hand, const SimObject& object, const EnvPhysics& physics)
      : scene(Options(kReferee), hand, {object}), model(scene.ModelFor(0, physics)) {
    data.reset(mj_makeData(model.get()));
    Rng rng(3, Stream::kTest);
    for (int j = 0; j < hand.num_joints(); ++j) {
      q.push_back(rng.Uniform(hand.joints[j].lower, hand.joints[j].upper));
      data->qpos[scene.DofOf(j)] = q.back();
    }
    mj_forward(model.get(), data.get());
  }
  MujocoScene scene;
  std::shared_ptr<const mjModel> model;
  MujocoData data;
  std::vector<double> q;
};

TEST(Mujoco, MassesInertiasLimitsAndRotorsAreTheHands) {
  const HandModel hand = LoadHand(HandOptions());
  const Posed posed(hand, scenes::Cube(), EnvPhysics());
  const mjModel& model = *posed.model;
  for (std::size_t i = 1; i < hand.links.size(); ++i) {
    const Link& link = hand.links[i];
    const int body = IdOf(model, mjOBJ_BODY, fmt::format("link{}", i));
    EXPECT_DOUBLE_EQ(model.body_mass[body], link.mass) << link.name;
    EXPECT_LT((Vector3d(model.body_ipos + 3 * body) - link.com).norm(), 1e-15) << link.name;
    EXPECT_LT((InertiaOf(model, body) - link.inertia).norm(), 1e-12 * link.inertia.norm())
        << link.name;
  }
  for (int j = 0; j < hand.num_joints(); ++j) {
    const int id = IdOf(model, mjOBJ_JOINT, fmt::format("joint{}", j));
    EXPECT_DOUBLE_EQ(model.jnt_range[2 * id], hand.joints[j].lower);
    EXPECT_DOUBLE_EQ(model.jnt_range[2 * id + 1], hand.joints[j].upper);
    EXPECT_DOUBLE_EQ(model.dof_armature[posed.scene.DofOf(j)], hand.armature);
  }
}

// The farthest that a vertex of `expected` is from the nearest vertex of mesh geom `geom` in the
// frame that (q, p) is the geom's pose in.
double MissedBy(const mjModel& model, int geom, const Quaterniond& q, const Vector3d& p,
                const std::vector<Vector3d>& expected) {
  const int mesh = model.geom_dataid[geom];
  double worst = 0;
  for (const Vector3d& vertex : expected) {
    double nearest = INFINITY;
    for (int i = 0; i < model.mesh_vertnum[mesh]; ++i) {
      const float* v = model.mesh_vert + 3 * (model.mesh_vertadr[mesh] + i);
      nearest = std::min(nearest, (q * Vector3d(v[0], v[1], v[2]) + p - vertex).norm());
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

TEST(Mujoco, LinksAndCollidersStandWhereForwardKinematicsPutsThem) {
  HandModel hand = LoadHand(HandOptions());
  Collider hull;  // the shipped hand has primitives only
  hull.shape = ColliderShape::kHull;
  hull.link = 3;
  hull.X_LC = {Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())), {.01, .02, 0}};
  hull.hull = Wedge().parts[0];
  hand.colliders.push_back(hull);
  const Posed posed(hand, scenes::Cube(), EnvPhysics());
  const std::vector<Pose> X_WL = ForwardKinematics(hand, posed.q.data());
  for (std::size_t i = 1; i < hand.links.size(); ++i) {
    const int body = IdOf(*posed.model, mjOBJ_BODY, fmt::format("link{}", i));
    EXPECT_LT((Vector3d(posed.data->xpos + 3 * body) - X_WL[i].p).norm(), 1e-12);
    EXPECT_LT(QuaternionAt(posed.data->xquat + 4 * body).angularDistance(X_WL[i].q), 1e-7);
  }
  for (std::size_t i = 0; i < hand.colliders.size(); ++i) {
    const Collider& collider = hand.colliders[i];
    const int geom = IdOf(*posed.model, mjOBJ_GEOM, fmt::format("collider{}", i));
    EXPECT_EQ(posed.scene.ColliderOf(geom), static_cast<int>(i));
    const Pose X_WC = X_WL[collider.link] * collider.X_LC;
    const Vector3d p(posed.data->geom_xpos + 3 * geom);
    const Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> >(
        posed.data->geom_xmat + 9 * geom);
    if (collider.shape != ColliderShape::kHull) {
      EXPECT_LT((p - X_WC.p).norm(), 1e-12);
      EXPECT_LT((R - X_WC.q.toRotationMatrix()).norm(), 1e-12);
      continue;
    }
    std::vector<Vector3d> expected;
    for (const Vector3d& vertex : collider.hull.vertices) expected.push_back(X_WC * vertex);
    EXPECT_LT(MissedBy(*posed.model, geom, Quaterniond(R), p, expected), 1e-7);
  }
}

TEST(Mujoco, TheObjectHasItsMassInertiaSizeAndCentreOfMass) {
  const SimObject object = Wedge();
  EnvPhysics physics;
  physics.mass = 0.13;
  physics.scale = 0.7;
  physics.com = {0.004, -0.003, 0.002};
  const Posed posed(scenes::PalmOnly(), object, physics);
  const int body = posed.scene.object_body();
  EXPECT_DOUBLE_EQ(posed.model->body_mass[body], 0.13);
  const Matrix3d inertia = 0.13 * 0.49 * object.unit_inertia;
  EXPECT_LT((InertiaOf(*posed.model, body) - inertia).norm(), 1e-12 * inertia.norm());
  // The body's origin is the centre of mass, so the part is shifted the other way.
  const int geom = IdOf(*posed.model, mjOBJ_GEOM, "part0");
  std::vector<Vector3d> expected;
  for (const Vector3d& vertex : object.parts[0].vertices)
    expected.push_back(0.7 * vertex - physics.com);
  const Vector3d p(posed.model->geom_pos + 3 * geom);
  EXPECT_LT(
      MissedBy(*posed.model, geom, QuaternionAt(posed.model->geom_quat + 4 * geom), p, expected),
      1e-7);
  // The sphere that broad-phase tests use covers the part.
  for (const Vector3d& vertex : expected)
    EXPECT_LE((vertex - p).norm(), posed.model->geom_rbound[geom] + 1e-7);
}

TEST(Mujoco, EnvironmentsWithEqualParametersShareAModel) {
  MujocoScene scene(Options(2), scenes::PalmOnly(), {scenes::Cube(), scenes::Cube(0.04)});
  EnvPhysics physics, heavier = {.mass = 0.2}, softer = {.torsional_friction = 0.004}, turned;
  turned.gravity = {0, 9.81, 0};  // not part of the model
  const auto model = scene.ModelFor(0, physics);
  EXPECT_EQ(scene.ModelFor(0, physics), model);
  EXPECT_EQ(scene.ModelFor(0, turned), model);
  EXPECT_NE(scene.ModelFor(0, heavier), model);
  EXPECT_NE(scene.ModelFor(0, softer), model);
  EXPECT_NE(scene.ModelFor(1, physics), model);
}

// Pairs of hand colliders that may touch: fingertips of different fingers, a fingertip and the
// palm; without friction.
TEST(Mujoco, FingersTouchEachOtherAndThePalmWithoutFriction) {
  const HandModel hand = LoadHand(HandOptions());
  const Posed posed(hand, scenes::Cube(), EnvPhysics());
  int tips = 0, crossings = 0, palm = 0;
  for (const Collider& a : hand.colliders) {
    tips += a.fingertip;
    palm += a.link == 0;
    for (const Collider& b : hand.colliders)
      crossings +=
          a.fingertip && b.fingertip && hand.links[a.link].chain < hand.links[b.link].chain;
  }
  ASSERT_GT(crossings, 0);
  EXPECT_EQ(posed.model->npair, crossings + tips * palm);
  for (int i = 0; i < posed.model->npair; ++i) EXPECT_EQ(posed.model->pair_dim[i], 1);
}

// The referee's time step is fine enough: a quarter of it changes little.
TEST(Mujoco, TheRefereesJointStepResponseIsConvergedToAFewMilliradians) {
  HandModel hand = LoadHand(HandOptions());
  Rig coarse(Options(kReferee), hand, {scenes::Cube()}), fine(Options(64), hand, {scenes::Cube()});
  EnvState state = scenes::StateAt(hand.num_joints(), {0, 0, 5});
  std::vector<double> targets(hand.num_joints());
  for (int j = 0; j < hand.num_joints(); ++j) {
    state.q[j] = (hand.joints[j].lower + hand.joints[j].upper) / 2;
    targets[j] = state.q[j] + (j % 2 == 0 ? 0.3 : -0.3);
  }
  coarse->SetState(0, state);
  fine->SetState(0, state);
  double apart = 0;
  for (int step = 0; step < 30; ++step) {
    coarse->Step(targets);
    fine->Step(targets);
    for (int j = 0; j < hand.num_joints(); ++j)
      apart = std::max(apart, std::abs(coarse->GetState(0).q[j] - fine->GetState(0).q[j]));
  }
  std::printf("joint step at 16 against 64 substeps: at most %.4f rad apart\n", apart);
  EXPECT_LT(apart, 0.005);
  EXPECT_NEAR(fine->GetState(0).q[0], targets[0], 0.05);
}

TEST(Mujoco, AFlatPartIsRefusedByName) {
  SimObject flat = scenes::Cube();
  flat.name = "flat";
  for (Vector3d& vertex : flat.parts[0].vertices) vertex.z() = 0;
  try {
    Rig rig(Options(2), scenes::PalmOnly(), {flat});
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find("object flat: part 0: volume"), 0u) << error.what();
  }
}

// Left alone, MuJoCo writes its errors and warnings to a file and ends the program.
TEST(Mujoco, ItsErrorsAreExceptionsAndItsWarningsLeaveNoLogFile) {
  HandModel hand = scenes::Rotor();
  hand.joints[0].upper = hand.joints[0].lower - 1;  // refused when the model is compiled
  EXPECT_THROW(Rig(Options(2), hand, {scenes::Cube()}), Error);
  EXPECT_THROW(mju_error("from a test"), Error);
  mju_warning("from a test");
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
}

TEST(Mujoco, ParametersThatAreNoPhysicsAreRefused) {
  Rig rig(Options(2), scenes::PalmOnly(), {scenes::Cube()});
  for (double EnvPhysics::*field : {&EnvPhysics::mass, &EnvPhysics::scale, &EnvPhysics::friction,
                                    &EnvPhysics::torsional_friction}) {
    EnvPhysics physics;
    physics.*field = -1;
    EXPECT_THROW(rig->SetObject(0, 0, physics), Error);
  }
}

TEST(Mujoco, ARealHandWithMeshesLoadsAndHoldsItsPose) {
  const char* urdf = std::getenv("DEX_REAL_HAND");
  if (urdf == nullptr) GTEST_SKIP() << "DEX_REAL_HAND is not set";
  HandOptions options;
  options.urdf = urdf;
  const HandModel hand = LoadHand(options);
  Rig rig(Options(kReferee), hand, {scenes::Cube()});
  EnvState state = scenes::StateAt(hand.num_joints(), {0, 0, 5});
  for (int j = 0; j < hand.num_joints(); ++j)
    state.q[j] = (hand.joints[j].lower + hand.joints[j].upper) / 2;
  rig->SetState(0, state);
  for (int step = 0; step < 60; ++step) rig->Step(state.q);
  for (int j = 0; j < hand.num_joints();
       ++j)  // but for the droop that the servo's stiffness allows
    EXPECT_NEAR(rig->GetState(0).q[j], state.q[j], 0.05) << hand.joints[j].name;
}

}  // namespace
}  // namespace dexremoe

#endif
