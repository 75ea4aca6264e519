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
