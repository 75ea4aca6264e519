// The project's own hand against the published figures, and kinematics against its derivative.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/random.h"
#include "geometry/hull.h"
#include "hand/hand_model.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

std::vector<double> RandomPose(const HandModel& hand, std::uint64_t number) {
  Rng rng(1, Stream::kTest, {number});
  std::vector<double> q;
  for (const Joint& joint : hand.joints) q.push_back(rng.Uniform(joint.lower, joint.upper));
  return q;
}

std::vector<Pose> TipPoses(const HandModel& hand, const std::vector<double>& q) {
  const std::vector<Pose> X_WL = ForwardKinematics(hand, q.data());
  std::vector<Pose> tips;
  for (std::size_t f = 0; f < hand.chains.size(); ++f)
    tips.push_back(X_WL[hand.joints[hand.chains[f].back()].child] * hand.tip_frames[f]);
  return tips;
}

class OwnHand : public testing::Test {
 protected:
  const HandModel hand_ = LoadHand({});
};

TEST_F(OwnHand, HasThreeFingersOfThreeFourAndFourJointsInTheOrderOfTheMotors) {
  ASSERT_EQ(hand_.num_joints(), 11);
  for (int j = 0; j < 11; ++j) {
    EXPECT_EQ(hand_.joints[j].name, "joint" + std::to_string(j + 1));
    EXPECT_EQ(hand_.joints[j].child, j + 1);
    EXPECT_LT(hand_.joints[j].parent, hand_.joints[j].child);
  }
  EXPECT_EQ(hand_.chains, (std::vector<std::vector<int>>{{0, 1, 2}, {3, 4, 5, 6}, {7, 8, 9, 10}}));
}

TEST_F(OwnHand, TipFramesAtRestAreThePublishedOnes) {
  const std::vector<Pose> tips = TipPoses(hand_, std::vector<double>(11, 0.0));
  const Vector3d positions[] = {
      {0.1779, 0.0198, 0.0060}, {0.0291, 0.2405, 0.0114}, {-0.0289, 0.2405, 0.0114}};
  Eigen::Matrix3d thumb, finger;  // columns are the axes of the tip frame in W
  thumb << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  finger << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  for (int f = 0; f < 3; ++f) {
    EXPECT_LT((tips[f].p - positions[f]).norm(), 1.5e-4) << f;
    EXPECT_LT((tips[f].q.toRotationMatrix() - (f == 0 ? thumb : finger)).norm(), 1e-4) << f;
  }
}

TEST_F(OwnHand, TotalMassIsTheLinksSumAndTipsCarryTheirBrackets) {
  double total = 0;
  for (const Link& link : hand_.links) total += link.mass;
  EXPECT_NEAR(total, 0.388202, 1e-5);
  // Bracket and shell of one finger: masses add, the centre is the weighted mean.
  const Link& tip = hand_.links[hand_.joints[6].child];
  EXPECT_NEAR(tip.mass, 0.00125017 + 0.0164248, 1e-7);
  EXPECT_NEAR(tip.com.x(), (0.00125017 * 0.0040781 + 0.0164248 * (0.0570187 - 0.025558)) / tip.mass,
              1e-6);
}

TEST_F(OwnHand, LimitsAreTheSmallerOfUrdfAndMotor) {
  EXPECT_EQ(hand_.joints[3].upper, 1.6);
  EXPECT_EQ(hand_.joints[7].upper, 2.23);
  for (const Joint& joint : hand_.joints) {
    EXPECT_EQ(joint.torque_limit, 0.5);  // the URDF says 10
    EXPECT_EQ(joint.speed_limit, 6.2);
  }
  HandOptions options;
  options.torque_limit = 100;
  options.speed_limit = 3;
  const HandModel other = LoadHand(options);
  EXPECT_EQ(other.joints[0].torque_limit, 10);
  EXPECT_EQ(other.joints[0].speed_limit, 3);
}

TEST_F(OwnHand, AFixedPointOfALinkMovesPerpendicularToItsJointsAxis) {
  // dp/dq_j = axis x (p - origin) for every joint below the point's link, zero for all others.
  const double step = 1e-6;
  const Vector3d p_L(0.01, -0.02, 0.03);
  for (int trial = 0; trial < 5; ++trial) {
    const std::vector<double> q = RandomPose(hand_, trial);
    const std::vector<Pose> X_WL = ForwardKinematics(hand_, q.data());
    for (int j = 0; j < hand_.num_joints(); ++j) {
      std::vector<double> low = q, high = q;
      low[j] -= step;
      high[j] += step;
      const auto X_low = ForwardKinematics(hand_, low.data());
      const auto X_high = ForwardKinematics(hand_, high.data());
      const Joint& joint = hand_.joints[j];
      const Vector3d axis_W = X_WL[joint.child].q * joint.axis;
      for (std::size_t link = 1; link < hand_.links.size(); ++link) {
        bool moves = false;
        for (int l = static_cast<int>(link); l > 0; l = hand_.links[l].parent)
          moves = moves || l == joint.child;
        const Vector3d slope = (X_high[link] * p_L - X_low[link] * p_L) / (2 * step);
        const Vector3d expected =
            moves ? axis_W.cross(X_WL[link] * p_L - X_WL[joint.child].p) : Vector3d::Zero();
        EXPECT_LT((slope - expected).norm(), 1e-8) << joint.name << " " << hand_.links[link].name;
      }
    }
  }
}

TEST_F(OwnHand, CollidersAreFewAndEveryFingerHasATip) {
  EXPECT_LE(hand_.colliders.size(), 16u);
  for (int chain = 0; chain < 3; ++chain) {
    const int last = hand_.joints[hand_.chains[chain].back()].child;
    EXPECT_TRUE(std::any_of(hand_.colliders.begin(), hand_.colliders.end(), [&](const Collider& c) {
      return c.fingertip && c.link == last && c.shape == ColliderShape::kCapsule;
    }));
  }
}

TEST_F(OwnHand, TipCapsulesFollowTheShellsPad) {
  // The visual shell is the published egg: on its pad side (link -y for the fingers) the union of
  // the capsules stays near it (against the published mesh itself: 0.8 mm in the mean).
  const int link = hand_.joints[6].child;
  double worst = 0, sum = 0;
  int count = 0;
  for (const Vector3d& p : hand_.links[link].visual.vertices) {
    if (p.y() > -2e-3 || p.x() < 0.016 || p.x() > 0.057) continue;
    double distance = INFINITY;
    for (const Collider& c : hand_.colliders) {
      if (c.link != link || !c.fingertip) continue;
      const Vector3d local = c.X_LC.Inverse() * p;
      const double z = std::clamp(local.z(), -c.half_length, c.half_length);
      distance = std::min(distance, (local - Vector3d(0, 0, z)).norm() - c.radius);
    }
    worst = std::max(worst, std::abs(distance));
    sum += std::abs(distance);
    ++count;
  }
  ASSERT_GT(count, 50);
  EXPECT_LT(worst, 3.5e-3);
  EXPECT_LT(sum / count, 1.3e-3);
}

TEST_F(OwnHand, VisualMeshesAreClosedAndColoured) {
  for (const Link& link : hand_.links) {
    EXPECT_EQ(link.visual.vertices.size(), link.visual_color.size());
    EXPECT_GT(MassPropertiesOf(link.visual).volume, 0) << link.name;
  }
}

TEST(RealHand, HasTheSameKinematicsMassesAndBounds) {
  const char* path = std::getenv("DEX_REAL_HAND");
  if (path == nullptr) GTEST_SKIP() << "DEX_REAL_HAND is not set";
  HandOptions options;
  const HandModel own = LoadHand(options);
  options.urdf = path;
  const HandModel real = LoadHand(options);
  ASSERT_EQ(real.num_joints(), own.num_joints());
  ASSERT_EQ(real.chains, own.chains);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<double> q = RandomPose(own, trial);
    const auto ours = TipPoses(own, q), theirs = TipPoses(real, q);
    for (int f = 0; f < 3; ++f) {
      EXPECT_LT((ours[f].p - theirs[f].p).norm(), 1e-6);
      EXPECT_LT(ours[f].q.angularDistance(theirs[f].q), 1e-6);
    }
  }
  for (std::size_t i = 0; i < own.links.size(); ++i) {
    EXPECT_NEAR(own.links[i].mass, real.links[i].mass, 1e-12);
    EXPECT_LT((own.links[i].com - real.links[i].com).norm(), 1e-9);
    EXPECT_LT((own.links[i].inertia - real.links[i].inertia).norm(), 1e-14);
  }
  for (std::size_t i = 0; i < own.links.size(); ++i) {  // our shapes fill the same boxes
    const Box3 a = BoundsOf(own.links[i].visual), b = BoundsOf(real.links[i].visual);
    EXPECT_LT((a.min - b.min).cwiseAbs().maxCoeff(), 4e-3) << own.links[i].name;
    EXPECT_LT((a.max - b.max).cwiseAbs().maxCoeff(), 4e-3) << own.links[i].name;
  }
  for (const Collider& c : real.colliders) {
    ASSERT_EQ(c.shape, ColliderShape::kHull) << c.name;
    EXPECT_LE(c.hull.vertices.size(), 32u) << c.name;
    for (const Vector3d& p : c.hull.vertices) EXPECT_LT(DistanceOutside(c.hull, p), 1e-9) << c.name;
  }
}

}  // namespace
}  // namespace dexremoe
