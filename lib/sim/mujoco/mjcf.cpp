#include "sim/mujoco/mjcf.h"

#include <Eigen/Eigenvalues>

#include "base/error.h"
#include "sim/sim_shared.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Settings of the referee. Contacts are springs without rebound that close to an overlap of a
// fraction of a millimetre at these forces; friction rows are ten times as stiff as normal ones,
// so that a grasp creeps little. The solver runs to convergence. Face contacts get several points.
constexpr char kHeader[] = R"(<mujoco>
<compiler angle="radian" inertiafromgeom="false"/>
<option timestep="{:.17g}" gravity="0 0 0" integrator="Euler" cone="elliptic" impratio="10"
 solver="Newton" iterations="50" tolerance="1e-10"><flag multiccd="enable"/></option>
<size nconmax="160" njmax="768"/>
<default>
<geom condim="3" friction="0 0 0" solref="0.006 1" solimp="0.95 0.99 0.0005"/>
<joint type="hinge" limited="true" solreflimit="0.002 1" solimplimit="0.99 0.999 0.0005"/>
<pair condim="1" solref="0.006 1" solimp="0.95 0.99 0.0005"/>
</default>
)";

constexpr double kLeastVolume = 1e-15;  // m^3; MuJoCo refuses flatter meshes

std::string Text(const Vector3d& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

std::string PoseText(const Eigen::Quaterniond& q, const Vector3d& p) {
  return fmt::format("pos=\"{}\" quat=\"{:.17g} {:.17g} {:.17g} {:.17g}\"", Text(p), q.w(), q.x(),
                     q.y(), q.z());
}

// Mass and inertia about `com` (in body axes) by principal axes.
std::string Inertial(double mass, const Vector3d& com, const Matrix3d& inertia,
                     const std::string& what) {
  if (!(mass > 0)) Fail("{}: mass: expected > 0 kg, found {}", what, mass);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
  if (!(solver.eigenvalues().minCoeff() > 0))
    Fail("{}: inertia: expected a positive definite matrix", what);
  Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) *= -1;
  return fmt::format("<inertial {} mass=\"{:.17g}\" diaginertia=\"{}\"/>\n",
                     PoseText(Eigen::Quaterniond(axes), com), mass, Text(solver.eigenvalues()));
}

// MuJoCo takes the convex hull; `what` names the mesh in errors.
std::string MeshText(const std::string& name, const TriMesh& mesh, const std::string& what) {
  const double volume = MassPropertiesOf(mesh).volume;
  if (!(volume > kLeastVolume))
    Fail("{}: volume: expected > {} m^3, found {}", what, kLeastVolume, volume);
  std::string text = fmt::format("<mesh name=\"{}\" vertex=\"", name);
  for (const Vector3d& vertex : mesh.vertices) text += Text(vertex) + " ";
  return text + "\"/>\n";
}

std::string GeomText(const Collider& collider, int index) {
  std::string shape;
  switch (collider.shape) {
    case ColliderShape::kSphere:
      shape = fmt::format("type=\"sphere\" size=\"{:.17g}\"", collider.radius);
      break;
    case ColliderShape::kCapsule:
      shape = fmt::format("type=\"capsule\" size=\"{:.17g} {:.17g}\"", collider.radius,
                          collider.half_length);
      break;
    case ColliderShape::kBox:
      shape = fmt::format("type=\"box\" size=\"{}\"", Text(collider.half_size));
      break;
    case ColliderShape::kHull:
      shape = fmt::format("type=\"mesh\" mesh=\"collider{}\"", index);
      break;
  }
  return fmt::format("<geom name=\"collider{}\" contype=\"1\" conaffinity=\"2\" {} {}/>\n", index,
                     shape, PoseText(collider.X_LC.q, collider.X_LC.p));
}

std::string CollidersOf(const HandModel& hand, int link) {
  std::string text;
  for (std::size_t i = 0; i < hand.colliders.size(); ++i)
    if (hand.colliders[i].link == link) text += GeomText(hand.colliders[i], static_cast<int>(i));
  return text;
}

// The links that hang on `parent`, each with its own children inside.
std::string LinksOn(const HandModel& hand, int parent) {
  std::string text;
  for (std::size_t j = 0; j < hand.joints.size(); ++j) {
    const Joint& joint = hand.joints[j];
    if (joint.parent != parent) continue;
    const Link& link = hand.links[joint.child];
    text += fmt::format("<body name=\"link{}\" {}>\n", joint.child,
                        PoseText(joint.X_PJ.q, joint.X_PJ.p));
    text += Inertial(link.mass, link.com, link.inertia, "link " + link.name);
    text += fmt::format(
        "<joint name=\"joint{}\" axis=\"{}\" range=\"{:.17g} {:.17g}\" armature=\"{:.17g}\"/>\n", j,
        Text(joint.axis), joint.lower, joint.upper, hand.armature);
    text += CollidersOf(hand, joint.child) + LinksOn(hand, joint.child) + "</body>\n";
  }
  return text;
}

std::string ObjectText(const SimObject& object) {
  std::string text = "<body name=\"object\"><freejoint name=\"object\"/>\n";
  text += Inertial(1, Vector3d::Zero(), object.unit_inertia, "object " + object.name);
  for (std::size_t i = 0; i < object.parts.size(); ++i)
    text += fmt::format(
        "<geom name=\"part{0}\" contype=\"2\" conaffinity=\"1\" type=\"mesh\" mesh=\"part{0}\"/>\n",
        i);
  return text + "</body>\n";
}

std::string PairsOf(const HandModel& hand) {
  std::string text;
  for (const auto& [i, j] : SelfContactPairs(hand))
    text += fmt::format("<pair geom1=\"collider{}\" geom2=\"collider{}\"/>\n", i, j);
  return text;
}

}  // namespace

std::string MjcfOf(const HandModel& hand, const SimObject& object, double time_step) {
  std::string text = fmt::format(kHeader, time_step);
  text += "<asset>\n";
  for (std::size_t i = 0; i < hand.colliders.size(); ++i)
    if (hand.colliders[i].shape == ColliderShape::kHull)
      text += MeshText(fmt::format("collider{}", i), hand.colliders[i].hull,
                       "collider " + hand.colliders[i].name);
  for (std::size_t i = 0; i < object.parts.size(); ++i)
    text += MeshText(fmt::format("part{}", i), object.parts[i],
                     fmt::format("object {}: part {}", object.name, i));
  text += "</asset>\n<worldbody>\n";
  text += CollidersOf(hand, 0) + LinksOn(hand, 0) + ObjectText(object);
  text += "</worldbody>\n<contact>\n" + PairsOf(hand) + "</contact>\n</mujoco>\n";
  return text;
}

}  // namespace dexremoe
