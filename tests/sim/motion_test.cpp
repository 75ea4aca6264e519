// The free object: closed forms and conservation laws.
#include <gtest/gtest.h>

#include <cmath>

#include "scenes.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using scenes::Rig;

const Vector3d kFarAway(0, 0, 3);

class Motion : public scenes::OnEveryEngine {};
DEX_RUN_ON_EVERY_ENGINE(Motion);

TEST_P(Motion, FreeFallFollowsTheDiscreteClosedForm) {
  const SimOptions options = Options(3);
  Rig rig(options, scenes::PalmOnly(), {scenes::Cube()});
  EnvPhysics physics;
  physics.gravity = {0.5, -1, 9.81};
  rig->SetObject(0, 0, physics);
  EnvState state = scenes::StateAt(0, kFarAway);
  state.v = {0.3, 0.2, -1};
  rig->SetState(0, state);
  for (int i = 0; i < 60; ++i) rig->Step({});
  // Semi-implicit Euler: v = v0 + n h g, p = p0 + n h v0 + n (n + 1) / 2 h^2 g.
  const double h = TimeStep(options);
  const double n = std::round(1 / h);
  const EnvState after = rig->GetState(0);
  EXPECT_LT((after.v - state.v - n * h * physics.gravity).norm(), GetParam().free_speed);
  const Vector3d expected =
      state.X_WO.p + n * h * state.v + 0.5 * n * (n + 1) * h * h * physics.gravity;
  EXPECT_LT((after.X_WO.p - expected).norm(), GetParam().free_distance);
}

TEST_P(Motion, AnOffsetCentreOfMassIsWhatMovesStraight) {
  Rig rig(Options(), scenes::PalmOnly(), {scenes::Cube()});
  EnvPhysics physics;
  physics.com = {0.01, -0.005, 0.004};
  physics.gravity.setZero();
  rig->SetObject(0, 0, physics);
  EnvState state = scenes::StateAt(0, kFarAway);
  state.v = {0.1, 0, 0};
  state.w = {0, 0, 8};
  rig->SetState(0, state);
  EXPECT_LT((rig->GetState(0).X_WO.p - kFarAway).norm(), GetParam().round_off);
  for (int i = 0; i < 60; ++i) rig->Step({});
  const EnvState after = rig->GetState(0);
  const Vector3d com = after.X_WO * physics.com;
  EXPECT_LT((com - (kFarAway + physics.com + state.v)).norm(), GetParam().free_distance);
}

struct Tumble {
  double momentum_error, energy_error;  // relative, after one second
};

Tumble TumbleFor(const SimOptions& options) {
  const SimObject object = scenes::Block({0.04, 0.06, 0.09});
  Rig rig(options, scenes::PalmOnly(), {object});
  EnvPhysics physics;
  physics.gravity.setZero();
  rig->SetObject(0, 0, physics);
  EnvState state = scenes::StateAt(0, kFarAway);
  state.w = {1, 5, 0.5};  // about the middle axis: unstable, so it tumbles
  rig->SetState(0, state);
  const auto momentum = [&](const EnvState& s) -> Vector3d {
    const Matrix3d R = s.X_WO.q.toRotationMatrix();
    return R * object.unit_inertia * R.transpose() * s.w;
  };
  const Vector3d L0 = momentum(state);
  const double E0 = state.w.dot(L0);
  for (int i = 0; i < 60; ++i) rig->Step({});
  const EnvState after = rig->GetState(0);
  const Vector3d L = momentum(after);
  return {(L - L0).norm() / L0.norm(), std::abs(after.w.dot(L) - E0) / E0};
}

// The gyroscopic term keeps the torque-free motion: the errors are of first order in the step.
// (Without it the angular velocity stays constant and the momentum turns with the body.)
TEST_P(Motion, MomentumAndEnergyErrorsOfATumblingBodyAreOfFirstOrder) {
  const Tumble coarse = TumbleFor(Options(4)), middle = TumbleFor(Options(8)),
               fine = TumbleFor(Options(16));
  std::printf("tumbling for 1 s: momentum error %.3g %.3g %.3g, energy %.3g %.3g %.3g\n",
              coarse.momentum_error, middle.momentum_error, fine.momentum_error,
              coarse.energy_error, middle.energy_error, fine.energy_error);
  EXPECT_LT(fine.momentum_error, 0.02);
  EXPECT_NEAR(middle.momentum_error / fine.momentum_error, 2, 0.4);
  EXPECT_NEAR(coarse.momentum_error / middle.momentum_error, 2, 0.6);
  EXPECT_LT(fine.energy_error, 0.02);
  EXPECT_NEAR(middle.energy_error / fine.energy_error, 2, 0.6);
}

TEST_P(Motion, APushThroughTheCentreAcceleratesByItsForceOverMassAndTurnsNothing) {
  // A push through the centre turns nothing; acceleration is force / mass at any scale.
  Rig rig(Options(), scenes::PalmOnly(), {scenes::Cube()});
  for (const double scale : {0.8, 1.3}) {
    EnvPhysics physics;
    physics.mass = 0.2;
    physics.scale = scale;
    physics.gravity.setZero();
    rig->SetObject(0, 0, physics);
    rig->SetState(0, scenes::StateAt(0, kFarAway));
    rig->PushObject(0, {0.4, 0, 0});
    rig->Step({});
    rig->Step({});  // the push lasts for one step only
    EXPECT_NEAR(rig->GetState(0).v.x(), 0.4 / 0.2 / 60, GetParam().free_speed);
    EXPECT_LT(rig->GetState(0).w.norm(), GetParam().free_speed);
  }
}

}  // namespace
}  // namespace dexremoe
