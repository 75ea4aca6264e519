// The search on the physics engine.
#include "task/grasp_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "geometry/hull.h"
#include "task/rotation.h"

namespace dexremoe {
namespace {

SimObject Cube(double side) {
  std::vector<Eigen::Vector3d> corners;
  for (int c = 0; c < 8; ++c)
    corners.push_back(side / 2 * Eigen::Vector3d(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1));
  SimObject cube;
  cube.name = "cube";
  cube.parts = {*ConvexHull(corners)};
  cube.unit_inertia = Eigen::Matrix3d::Identity() * side * side / 6;
  cube.radius = side * std::sqrt(0.75);
  return cube;
}

struct Search {
  GraspSet Run(const SimObject& object, int workers) {
    ThreadPool pool(workers);
    return FindGrasps(options, task, sim, hand, object, 1, pool, &counts);
  }
  GraspOptions options;
  TaskOptions task;
  SimOptions sim;
  HandModel hand = LoadHand({});
  GraspCounts counts;
};

TEST(GraspSearch, FindsGraspsOfACubeWhateverTheWorkers) {
  Search search;
  search.options.count = 20;
  const GraspSet one = search.Run(Cube(0.05), 1);
  const GraspCounts counts = search.counts;
  ASSERT_EQ(one.grasps.size(), 20u);
  EXPECT_GT(one.acceptance, 0.2);
  EXPECT_EQ(counts.tried,
            counts.blocked + counts.no_grip + counts.dropped + counts.moving + counts.accepted);
  const GraspSet two = search.Run(Cube(0.05), 2);
  ASSERT_EQ(two.grasps.size(), 20u);
  EXPECT_EQ(one.acceptance, two.acceptance);
  for (int g = 0; g < 20; ++g) {
    EXPECT_EQ(one.grasps[g].q, two.grasps[g].q);
    EXPECT_EQ(one.grasps[g].X_WO.p, two.grasps[g].X_WO.p);
  }

  // What was found holds: episodes that start there and do nothing keep the object.
  TaskObject object;
  object.name = "cube";
  object.sim = Cube(0.05);
  object.grasps = one.grasps;
  ThreadPool pool(2);
  ReorientBatch batch(search.task, search.sim, search.hand, {object}, 40, 3, pool);
  const std::vector<double> start = batch.distance();
  const std::vector<float> nothing(40 * 11, 0.0f);
  for (int step = 0; step < 60; ++step) batch.Step(nothing);
  int kept = 0;
  for (int env = 0; env < 40; ++env) kept += batch.distance()[env] < start[env] + 0.01;
  EXPECT_GE(kept, 36);
}

// Found where a step is a whole control step, kept only if four smaller steps agree: every grasp
// holds when it is replayed there, by the conditions of the search.
TEST(GraspSearch, CertifiedGraspsHoldOnTheCertifyingEngine) {
  Search search;
  search.sim.substeps = 1;
  search.task.mass_range = {0.08, 0.08};
  search.task.friction_range = {0.45, 0.45};  // slippery: some grasps hold on one side only
  search.options.count = 40;
  search.options.certify = "ode";
  search.options.certify_substeps = 4;
  const SimObject cube = Cube(0.05);
  const GraspSet set = search.Run(cube, 2);
  const GraspCounts& counts = search.counts;
  EXPECT_EQ(counts.certified + counts.refused, counts.accepted);
  EXPECT_GT(counts.refused, 0);
  ASSERT_GE(counts.certified, static_cast<int>(set.grasps.size()));
  EXPECT_DOUBLE_EQ(set.acceptance, static_cast<double>(counts.certified) / counts.tried);

  ThreadPool pool(2);
  SimOptions fine = search.sim;
  fine.substeps = 4;
  const int n = static_cast<int>(set.grasps.size());
  const auto sim = MakeBatchSim(fine, search.hand, {cube}, n, pool);
  EnvPhysics physics;
  physics.mass = 0.08;
  physics.friction = 0.45;
  std::vector<double> targets;
  for (int env = 0; env < n; ++env) {
    const Grasp& grasp = set.grasps[env];
    sim->SetObject(env, 0, physics);
    sim->SetState(env, {grasp.q, std::vector<double>(grasp.q.size(), 0.0), grasp.X_WO});
    targets.insert(targets.end(), grasp.target.begin(), grasp.target.end());
  }
  for (int step = 0; step < search.options.hold_steps; ++step) sim->Step(targets);
  const Eigen::Vector3d center(search.task.grasp_center.data());
  for (int env = 0; env < n; ++env)
    EXPECT_LE((sim->GetState(env).X_WO.p - center).norm(), search.options.max_distance) << env;
}

TEST(GraspSearch, CertificationByTheSameEngineAndStepsRefusesFew) {
  Search search;
  search.options.count = 20;
  search.options.certify = "ode";
  search.options.certify_substeps = search.sim.substeps;
  search.Run(Cube(0.05), 2);
  EXPECT_LE(search.counts.refused, search.counts.accepted / 10);
}

TEST(GraspSearch, SaysWhyNothingWasFound) {
  Search search;
  search.options.candidates = 128;
  search.options.hold_steps = 1;
  try {
    search.Run(Cube(0.002), 2);
    FAIL() << "grasped a grain";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("cube"));
    EXPECT_THAT(error.what(), testing::HasSubstr("128 tried"));
    EXPECT_THAT(error.what(), testing::HasSubstr("without grip"));
  }
}

TEST(GraspSearch, ListsMustFitTheHand) {
  Search search;
  search.options.open_pose.pop_back();
  EXPECT_THROW(search.Run(Cube(0.05), 1), UsageError);
}

}  // namespace
}  // namespace dexremoe
