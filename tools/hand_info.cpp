// Prints what a hand description holds: tree, limits, masses, inertias, colliders, fingertips.

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "base/options.h"
#include "hand/hand_model.h"

namespace dexremoe {
namespace {

const char* ShapeName(ColliderShape shape) {
  switch (shape) {
    case ColliderShape::kSphere:
      return "sphere";
    case ColliderShape::kCapsule:
      return "capsule";
    case ColliderShape::kBox:
      return "box";
    case ColliderShape::kHull:
      return "hull";
  }
  return "?";
}

std::string SizeText(const Collider& c) {
  switch (c.shape) {
    case ColliderShape::kSphere:
      return fmt::format("r {:.2f}", 1e3 * c.radius);
    case ColliderShape::kCapsule:
      return fmt::format("r {:.2f}, length {:.2f}", 1e3 * c.radius, 2e3 * c.half_length);
    case ColliderShape::kBox: {
      const Eigen::Vector3d s = 2e3 * c.half_size;
      return fmt::format("{:.1f} x {:.1f} x {:.1f}", s.x(), s.y(), s.z());
    }
    case ColliderShape::kHull:
      return fmt::format("{} vertices", c.hull.vertices.size());
  }
  return "";
}

// Rounding leaves numbers like -1e-17, which would print as -0.00.
double Clean(double x) { return std::abs(x) < 1e-9 ? 0 : x; }

void PrintJoints(const HandModel& hand) {
  fmt::print("\n{:<8} {:<10} {:<10} {:>8} {:>8} {:>8} {:>8}  {}\n", "joint", "parent", "child",
             "lower", "upper", "torque", "speed", "axis in W at q = 0");
  fmt::print("{:<8} {:<10} {:<10} {:>8} {:>8} {:>8} {:>8}\n", "", "", "", "rad", "rad", "N m",
             "rad/s");
  const std::vector<double> zero(hand.joints.size(), 0.0);
  const std::vector<Pose> X_WL = ForwardKinematics(hand, zero.data());
  for (const Joint& j : hand.joints) {
    const Eigen::Vector3d axis = X_WL[j.child].q * j.axis;
    fmt::print("{:<8} {:<10} {:<10} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.2f}  {:5.2f} {:5.2f} {:5.2f}\n",
               j.name, hand.links[j.parent].name, hand.links[j.child].name, j.lower, j.upper,
               j.torque_limit, j.speed_limit, Clean(axis.x()), Clean(axis.y()), Clean(axis.z()));
  }
}

void PrintLinks(const HandModel& hand) {
  fmt::print("\n{:<10} {:>7} {:>8}  {:^24}  {:^51} {:>9}\n", "link", "finger", "mass",
             "centre of mass", "inertia xx yy zz xy xz yz", "visual");
  fmt::print("{:<10} {:>7} {:>8}  {:^24}  {:^51} {:>9}\n", "", "", "g", "mm", "g mm^2",
             "triangles");
  for (const Link& l : hand.links) {
    const Eigen::Vector3d c = 1e3 * l.com;
    const Eigen::Matrix3d I = 1e9 * l.inertia;
    fmt::print(
        "{:<10} {:>7} {:>8.3f}  {:>7.2f} {:>7.2f} {:>7.2f}  {:>9.1f} {:>9.1f} {:>9.1f} "
        "{:>7.1f} {:>7.1f} {:>7.1f} {:>9}\n",
        l.name, l.chain < 0 ? "-" : std::to_string(l.chain), 1e3 * l.mass, c.x(), c.y(), c.z(),
        I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2), l.visual.triangles.size());
  }
}

void PrintColliders(const HandModel& hand) {
  fmt::print("\n{:<28} {:<10} {:<8} {:<26} {:^24} {}\n", "collider", "link", "shape", "size, mm",
             "centre in link, mm", "tip");
  for (const Collider& c : hand.colliders) {
    const Eigen::Vector3d p =
        1e3 * (c.shape == ColliderShape::kHull ? c.X_LC * BoundsOf(c.hull).Center() : c.X_LC.p);
    fmt::print("{:<28} {:<10} {:<8} {:<26} {:>7.2f} {:>7.2f} {:>7.2f}  {}\n", c.name,
               hand.links[c.link].name, ShapeName(c.shape), SizeText(c), p.x(), p.y(), p.z(),
               c.fingertip ? "yes" : "");
  }
}

void PrintTips(const HandModel& hand) {
  const std::vector<double> zero(hand.joints.size(), 0.0);
  const std::vector<Pose> X_WL = ForwardKinematics(hand, zero.data());
  fmt::print("\n{:<8} {:<26} {}\n", "finger", "joints", "tip in W at q = 0, mm");
  for (std::size_t f = 0; f < hand.chains.size(); ++f) {
    std::string names;
    for (const int j : hand.chains[f]) names += (names.empty() ? "" : " ") + hand.joints[j].name;
    const Pose X_WF = X_WL[hand.joints[hand.chains[f].back()].child] * hand.tip_frames[f];
    const Eigen::Vector3d p = 1e3 * X_WF.p;
    fmt::print("{:<8} {:<26} {:>7.2f} {:>7.2f} {:>7.2f}\n", f, names, p.x(), p.y(), p.z());
  }
}

void Run(const HandOptions& options) {
  const HandModel hand = LoadHand(options);
  double mass = 0;
  for (const Link& link : hand.links) mass += link.mass;
  fmt::print("hand        {} ({})\n", hand.name, hand.source);
  fmt::print("links       {}, joints {}, fingers {}, colliders {}\n", hand.links.size(),
             hand.joints.size(), hand.chains.size(), hand.colliders.size());
  fmt::print("total mass  {:.3f} g\n", 1e3 * mass);
  fmt::print("servo       kp {} N m/rad, kd {} N m s/rad, armature {} kg m^2\n", hand.kp, hand.kd,
             hand.armature);
  PrintJoints(hand);
  PrintLinks(hand);
  PrintColliders(hand);
  PrintTips(hand);
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("hand_info", "Prints a hand's tree, limits, masses, inertias and colliders.",
                  "hand_info --hand=data/hand/gx11.urdf");
  HandOptions hand;
  hand.Register(options);
  return RunTool(options, argc, argv, [&] { Run(hand); });
}
