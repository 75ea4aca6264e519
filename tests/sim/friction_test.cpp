// A block on the upturned palm: rest, slip angle, impact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;
using scenes::Rig;

const Vector3d kFlatBlock(0.06, 0.06, 0.02);

// Speed of the block half a second after it was put on the tilted palm.
double SlideSpeed(const SimOptions& options, double friction, double slope, double direction) {
  Rig rig(options, scenes::PalmOnly(), {scenes::Block(kFlatBlock)});
  const double tilt = std::atan(slope);
  EnvPhysics physics;
  physics.friction = friction;
  physics.gravity = 9.81 * Vector3d(std::sin(tilt) * std::cos(direction),
                                    std::sin(tilt) * std::sin(direction), -std::cos(tilt));
  rig->SetObject(0, 0, physics);
  rig->SetState(0, scenes::StateAt(0, {0, 0, 0.0101}));
  for (int i = 0; i < 20; ++i) rig->Step({});
  const Vector3d start = rig->GetState(0).X_WO.p;
  for (int i = 0; i < 20; ++i) rig->Step({});
  return (rig->GetState(0).X_WO.p - start).norm() * 3;
}

double SlipSlope(const SimOptions& options, double friction, double direction) {
  double holds = 0, slides = 2 * friction;
  for (int i = 0; i < 10; ++i) {
    const double middle = (holds + slides) / 2;
    (SlideSpeed(options, friction, middle, direction) > 5e-3 ? slides : holds) = middle;
  }
  return holds;
}

class Friction : public scenes::OnEveryEngine {};
DEX_RUN_ON_EVERY_ENGINE(Friction);
class Contact : public scenes::OnEveryEngine {};
DEX_RUN_ON_EVERY_ENGINE(Contact);

// The gap to Coulomb's law: the slope at which the block starts to slide against mu.
TEST_P(Friction, TheSlipAngleIsAtanMuInAnyDirection) {
  for (const int substeps : GetParam().substeps) {
    if (substeps < 2) continue;  // promised from two substeps on
    for (const double direction : {0.0, 0.4, M_PI / 4})
      for (const double mu : {0.2, 0.5, 1.0}) {
        const double slope = SlipSlope(Options(substeps), mu, direction);
        const double error = (std::atan(slope) - std::atan(mu)) * 180 / M_PI;
        std::printf("substeps %d direction %.2f mu %.1f: slips at tan %.4f (%+.2f degrees)\n",
                    substeps, direction, mu, slope, error);
        EXPECT_NEAR(error, 0, GetParam().slip_angle) << "substeps " << substeps << " mu " << mu;
      }
  }
}

TEST_P(Friction, ASlidingBlockAcceleratesAsCoulombSays) {
  const double mu = 0.3, slope = 0.8, tilt = std::atan(slope);
  Rig rig(Options(GetParam().substeps.back()), scenes::PalmOnly(), {scenes::Block(kFlatBlock)});
  EnvPhysics physics;
  physics.friction = mu;
  physics.gravity = 9.81 * Vector3d(std::sin(tilt), 0, -std::cos(tilt));
  rig->SetObject(0, 0, physics);
  rig->SetState(0, scenes::StateAt(0, {-0.1, 0, 0.0101}));
  for (int i = 0; i < 6; ++i) rig->Step({});
  const double before = rig->GetState(0).v.x();
  for (int i = 0; i < 12; ++i) rig->Step({});
  const double acceleration = (rig->GetState(0).v.x() - before) / 0.2;
  EXPECT_NEAR(acceleration, 9.81 * (std::sin(tilt) - mu * std::cos(tilt)), 0.1);
}

TEST_P(Contact, ACubeAtRestStaysBelowTheSuccessThresholdsAndDoesNotSink) {
  for (const int substeps : GetParam().substeps) {
    Rig rig(Options(substeps), scenes::PalmOnly(), {scenes::Cube()});
    EnvPhysics physics;
    physics.gravity = {0, 0, -9.81};
    rig->SetObject(0, 0, physics);
    rig->SetState(0, scenes::StateAt(0, {0, 0, 0.0277}));
    for (int i = 0; i < 300; ++i) {
      rig->Step({});
      const EnvState state = rig->GetState(0);
      ASSERT_LT(state.w.norm(), 0.5);
      if (i > 5) {
        ASSERT_LT(state.v.norm(), 0.04);
      }
    }
    const Vector3d p = rig->GetState(0).X_WO.p;
    EXPECT_NEAR(p.z(), 0.0275 + GetParam().rest_gap, GetParam().rest_gap_error);
    EXPECT_LT(std::hypot(p.x(), p.y()), 1e-4);
    EXPECT_GE(rig->state().contact_count[0], 3);
  }
}

TEST_P(Contact, ADroppedCubePenetratesLittleAndComesToRest) {
  for (const int substeps : GetParam().substeps) {
    Rig rig(Options(substeps), scenes::PalmOnly(), {scenes::Cube()});
    EnvPhysics physics;
    physics.gravity = {0, 0, -9.81};
    rig->SetObject(0, 0, physics);
    EnvState state = scenes::StateAt(0, {0, 0, 0.15});
    state.X_WO.q = Eigen::AngleAxisd(0.7, Vector3d(1, 0.5, 0.2).normalized());
    rig->SetState(0, state);
    double deepest = 0;
    for (int i = 0; i < 180; ++i) {
      rig->Step({});
      deepest = std::max(deepest, rig->state().max_penetration[0]);
    }
    std::printf("dropped from 12 cm, substeps %d: deepest %.2f mm\n", substeps, 1e3 * deepest);
    EXPECT_LT(deepest, GetParam().impact_depth);
    EXPECT_LT(rig->GetState(0).v.norm(), 0.01);
    EXPECT_NEAR(rig->GetState(0).X_WO.p.z(), 0.0275 + GetParam().rest_gap, 1e-4);
  }
}

}  // namespace
}  // namespace dexremoe
