// The measurements behind validate_sim and bench_sim: each number against what is known of it.
#include "eval/sim_validation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "eval/sim_bench.h"
#include "eval/sim_scenes.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

SimOptions Ode(int substeps) { return SettingOf(SimOptions(), "ode", substeps).sim; }

GraspedObject HeldCube(int count, ThreadPool& pool) {
  GraspOptions options;
  options.count = count;
  const SimObject cube = BoxObject("cube", Vector3d::Constant(0.055));
  return {cube, GraspsOf(cube, options, TaskOptions(), Ode(2), LoadHand({}), 1, pool)};
}

TEST(SimScenes, ACompoundOfTwoHalvesIsTheWhole) {
  const SimObject whole = BoxObject("box", {0.06, 0.04, 0.02});
  ConvexParts halves = {BoxObject("a", {0.03, 0.04, 0.02}).parts[0],
                        BoxObject("b", {0.03, 0.04, 0.02}).parts[0]};
  for (Vector3d& p : halves[1].vertices) p.x() += 0.03;
  const SimObject compound = CompoundObject("halves", halves);
  EXPECT_LT((compound.unit_inertia - whole.unit_inertia).norm(), 1e-12);
  EXPECT_NEAR(compound.radius, whole.radius, 1e-12);
  const Vector3d s2 = Vector3d(0.06, 0.04, 0.02).cwiseAbs2() / 12;
  const Vector3d expected(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y());
  EXPECT_LT((whole.unit_inertia.diagonal() - expected).norm(), 1e-12);
}

TEST(SimScenes, ShapesAreCenteredAndOfTheSizeOfAGrasp) {
  std::vector<SimObject> shapes = ValidationShapes();
  for (const SimObject& body : RandomCompounds(20, 3)) shapes.push_back(body);
  for (const SimObject& shape : shapes) {
    EXPECT_GT(shape.radius, 0.015) << shape.name;
    EXPECT_LT(shape.radius, 0.065) << shape.name;
    Vector3d moment = Vector3d::Zero();
    for (const TriMesh& part : shape.parts) {
      const MassProperties mass = MassPropertiesOf(part);
      EXPECT_GT(mass.volume, 0) << shape.name;
      moment += mass.volume * mass.center;
    }
    EXPECT_LT(moment.norm(), 1e-12) << shape.name;
  }
}

TEST(SimScenes, ARandomBodyDependsOnItsNumberAlone) {
  const auto few = RandomCompounds(3, 5), many = RandomCompounds(9, 5);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(few[i].unit_inertia, many[i].unit_inertia);
  EXPECT_NE(many[1].unit_inertia, many[2].unit_inertia);
}

TEST(SimTable, RowsAndColumnsStandInOrderOfAppearance) {
  const std::vector<Measurement> all = {{"t", "b", "y", 1.25, 1, ""},
                                        {"other", "b", "y", 7, 1, ""},
                                        {"t", "a", "x", 2, 0, "+- 1"},
                                        {"t", "a", "y", NAN, 0, ""}};
  EXPECT_EQ(MarkdownOf(all, "t", "row"),
            "| row |   y |      x |\n"
            "|:----|----:|-------:|\n"
            "| b   | 1.2 |        |\n"
            "| a   |   - | 2 +- 1 |\n");
  EXPECT_EQ(MarkdownOf(all, "absent", "row"), "");
  EXPECT_THAT(CsvOf(all), HasSubstr("t,a,x,2,+- 1\nt,a,y,,\n"));
}

TEST(SimValidation, FreeFallOfOdeLagsByHalfAStepOfSpeed) {
  ThreadPool pool(1);
  for (const int substeps : {1, 4}) {
    const FallError error = FreeFallError(Ode(substeps), pool);
    EXPECT_NEAR(error.position, 9.81 / 2 / (60 * substeps), 1e-6);  // g t h / 2
    EXPECT_LT(error.velocity, 1e-9);
  }
}

TEST(SimValidation, TumbleErrorsOfOdeAreOfFirstOrder) {
  ThreadPool pool(1);
  const TumbleError coarse = TumbleErrors(Ode(8), pool), fine = TumbleErrors(Ode(16), pool);
  EXPECT_NEAR(coarse.momentum / fine.momentum, 2, 0.4);
  EXPECT_NEAR(coarse.energy / fine.energy, 2, 0.6);
}

TEST(SimValidation, JointStepsConvergeAndArriveAtTheirTargets) {
  ThreadPool pool(1);
  const HandModel hand = LoadHand({});
  const auto response = [&](int substeps) {
    return JointStepResponse(Ode(substeps), hand, 0.3, 30, pool);
  };
  const auto difference = [](const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
    return worst;
  };
  const auto fine = response(32), middle = response(8), coarse = response(2);
  ASSERT_EQ(fine.size(), 30u * hand.num_joints());
  EXPECT_LT(difference(middle, fine), difference(coarse, fine));
  EXPECT_LT(difference(coarse, fine), 0.05);
  const double start = (hand.joints[4].lower + hand.joints[4].upper) / 2;
  EXPECT_NEAR(fine[29 * hand.num_joints() + 4], start + 0.3, 0.03);
}

TEST(SimValidation, TheSlipAngleOfOdeIsAtanMu) {
  ThreadPool pool(2);
  EXPECT_NEAR(SlipAngle(Ode(4), 0.5, 0.4, pool), std::atan(0.5), 0.01);
}

TEST(SimValidation, GraspsHoldWithFrictionAndFallWithout) {
  ThreadPool pool(2);
  const GraspedObject cube = HeldCube(12, pool);
  ASSERT_EQ(cube.grasps.size(), 12u);
  const HandModel hand = LoadHand({});
  const HoldFigures rough = HoldGrasps(Ode(2), hand, TaskOptions(), cube, 1.0, pool);
  EXPECT_EQ(rough.tried, 12);
  EXPECT_GE(rough.held, 11);
  EXPECT_GE(rough.quiet, 11);
  const HoldFigures smooth = HoldGrasps(Ode(2), hand, TaskOptions(), cube, 0.0, pool);
  EXPECT_LE(smooth.held, 4);
  const HoldFigures none = HoldGrasps(Ode(2), hand, TaskOptions(), {cube.sim, {}}, 1, pool);
  EXPECT_TRUE(std::isnan(none.HeldShare()));
}

TEST(SimValidation, SurvivalIsAFullEpisodeWithoutNoiseAndRepeatsWithIt) {
  const HandModel hand = LoadHand({});
  SimValidationOptions options;
  options.episodes = 8;
  options.noise = 0;
  TaskOptions task;
  task.episode_length = 40;
  ThreadPool one(1), two(2);
  const GraspedObject cube = HeldCube(4, two);
  EXPECT_EQ(Survive(Ode(2), hand, task, cube, options, two).steps, 40);
  options.noise = 1;
  task.episode_length = 600;
  const SurvivalFigures a = Survive(Ode(2), hand, task, cube, options, one);
  const SurvivalFigures b = Survive(Ode(2), hand, task, cube, options, two);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.depth_max, b.depth_max);
  EXPECT_GT(a.steps, 5);
  EXPECT_LT(a.steps, 400);
  EXPECT_LE(a.depth_95, a.depth_99);
  EXPECT_LE(a.depth_99, a.depth_max);
  EXPECT_GT(a.depth_max, 0);
}

TEST(SimValidation, SettingsEndWithTheReferee) {
  const auto settings = ValidationSettings({"lanes", "ode", "mujoco"}, {});
  EXPECT_EQ(settings.back().label, "mujoco 17");
  EXPECT_EQ(settings.front().sim.engine, "lanes");
  EXPECT_EQ(settings.front().sim.iterations, SimOptions().iterations);
  for (std::size_t i = 0; i < settings.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(settings[i].label, settings[k].label);
}

TEST(SimValidation, EveryTableHasItsNumbers) {
  SimValidationOptions options;
  options.MakeQuick();
  ThreadPool pool(2);
  const std::vector<SimObject> shapes = {ValidationShapes()[0]};
  const SimValidation result = ValidateSim(options, LoadHand({}), TaskOptions(), shapes, pool);
  for (const char* table : {"goals", "motion", "joint", "slip", "found", "held ode", "quiet",
                            "friction", "survival", "depth"})
    EXPECT_NE(MarkdownOf(result.measurements, table, ""), "") << table;
  EXPECT_THAT(result.Markdown(), HasSubstr("ode 2"));
}

TEST(SimBench, SpreadsAndRatiosAreTakenSliceBySlice) {
  const Spread spread = SpreadOf({3, 1, 10, 2});
  EXPECT_EQ(spread.median, 2.5);
  EXPECT_EQ(spread.low, 1);
  EXPECT_EQ(spread.high, 10);
  // The machine was three times slower in the second slice: the ratio does not see it.
  const Spread ratio = RatioOf({30, 10, 30}, {6, 2, 6});
  EXPECT_EQ(ratio.low, 5);
  EXPECT_EQ(ratio.high, 5);
}

TEST(SimBench, ARolloutPutsFallenObjectsBack) {
  ThreadPool pool(2);
  const HandModel hand = LoadHand({});
  const TaskOptions task;
  RandomRollout rollout(Ode(1), hand, task, {HeldCube(4, pool)}, 16, 1.5, 1, pool);
  for (int step = 0; step < 150; ++step) {
    const RandomRollout::Cost cost = rollout.Step();
    EXPECT_GT(cost.wall, 0);
    EXPECT_GT(cost.cpu, 0);
    for (int env = 0; env < 16; ++env)
      EXPECT_LE(GraspDistance(rollout.sim().state(), env, task), task.fall_distance);
  }
  EXPECT_GT(rollout.falls(), 0);
}

TEST(SimBench, AnObjectWithoutGraspsIsNamed) {
  ThreadPool pool(1);
  const SimObject cube = BoxObject("lonely", Vector3d::Constant(0.05));
  EXPECT_THROW(RandomRollout(Ode(1), LoadHand({}), TaskOptions(), {{cube, {}}}, 4, 1, 1, pool),
               Error);
}

TEST(SimBench, EveryTableHasItsNumbers) {
  SimBenchOptions options;
  options.MakeQuick();
  const SimBenchResult result = RunSimBench(options, LoadHand({}), TaskOptions(), 2);
  for (const char* table : {"rate", "environments", "objects", "memory"})
    EXPECT_NE(MarkdownOf(result.measurements, table, ""), "") << table;
  for (const Measurement& m : result.measurements)
    if (m.table == "rate" && m.column != "steps per fall") {
      EXPECT_GT(m.value, 0) << m.row << ", " << m.column;
    }
}

}  // namespace
}  // namespace dexremoe
