// From a URDF file to a HandModel: walks the tree from the base, merges what is fixed.

#include <console_bridge/console.h>
#include <urdf_model/joint.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <map>
#include <mutex>
#include <set>

#include "base/error.h"
#include "hand/hand_model.h"
#include "hand/urdf_geometry.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

using internal::PoseOf;

// Keeps the first complaint of the parser, which would otherwise go to stderr.
class FirstMessage : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && text_.empty()) text_ = text;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

urdf::ModelInterfaceSharedPtr Parse(const std::string& path) {
  static std::mutex mutex;  // the parser's output handler is a global
  const std::lock_guard lock(mutex);
  const std::string xml = ReadFile(path);
  FirstMessage message;
  console_bridge::OutputHandler* before = console_bridge::getOutputHandler();
  console_bridge::useOutputHandler(&message);
  urdf::ModelInterfaceSharedPtr model;
  std::string thrown;
  try {
    model = urdf::parseURDF(xml);
  } catch (const std::exception& error) {
    thrown = error.what();
  }
  console_bridge::useOutputHandler(before);
  if (model == nullptr) {
    std::string text = message.text().empty() ? thrown : message.text();
    std::replace(text.begin(), text.end(), '\n', ' ');
    Fail("{}: expected a URDF robot, found: {}", path, text.empty() ? "something else" : text);
  }
  return model;
}

// "joint2" < "joint10": runs of digits compare as numbers.
bool NaturalLess(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      std::size_t m = i, n = j;
      while (m < a.size() && digit(a[m])) ++m;
      while (n < b.size() && digit(b[n])) ++n;
      const std::string x = a.substr(i, m - i), y = b.substr(j, n - j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
      i = m;
      j = n;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j;
}

// Inertia about the common centre of mass (parallel axes).
void AddMass(double mass, const Eigen::Vector3d& com, const Eigen::Matrix3d& inertia, Link& link) {
  const double total = link.mass + mass;
  if (total <= 0) return;
  const Eigen::Vector3d center = (link.mass * link.com + mass * com) / total;
  const auto about = [&](double m, const Eigen::Vector3d& c, const Eigen::Matrix3d& I) {
    const Eigen::Vector3d d = c - center;
    return Eigen::Matrix3d(I +
                           m * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose()));
  };
  link.inertia = about(link.mass, link.com, link.inertia) + about(mass, com, inertia);
  link.mass = total;
  link.com = center;
}

class Loader {
 public:
  explicit Loader(const HandOptions& options)
      : options_(options), path_(options.urdf), urdf_(Parse(options.urdf)) {}

  HandModel Load() {
    CheckEveryLinkHasOneParent();
    hand_.name = urdf_->getName();
    hand_.source = path_;
    hand_.kp = options_.kp;
    hand_.kd = options_.kd;
    hand_.armature = options_.armature;
    const urdf::LinkConstSharedPtr root = urdf_->getRoot();
    hand_.links.emplace_back().name = root->name;
    Visit(*root, 0, Pose());
    if (seen_.size() != urdf_->links_.size())
      Fail("{}: expected one tree, found {} links that the base '{}' does not carry (a loop)",
           path_, urdf_->links_.size() - seen_.size(), root->name);
    if (hand_.joints.empty()) Fail("{}: expected revolute joints, found none", path_);
    for (std::size_t i = 1; i < hand_.links.size(); ++i) CheckMass(hand_.links[i]);
    return std::move(hand_);
  }

 private:
  void CheckEveryLinkHasOneParent() const {
    std::set<std::string> children;
    for (const auto& [name, joint] : urdf_->joints_)
      if (!children.insert(joint->child_link_name).second)
        Fail("{}: joint '{}': expected a child link of its own, found '{}' again (a loop)", path_,
             name, joint->child_link_name);
  }

  // Adds URDF link `source`, standing at X_LB in moving link `link`, and everything beyond it.
  void Visit(const urdf::Link& source, int link, const Pose& X_LB) {
    seen_.insert(source.name);
    AbsorbMass(source, link, X_LB);
    std::vector<urdf::JointSharedPtr> joints = source.child_joints;
    std::sort(joints.begin(), joints.end(),
              [](const auto& a, const auto& b) { return NaturalLess(a->name, b->name); });
    const bool leaf = joints.empty() && link > 0;
    internal::AppendColliders(path_, source, link, X_LB, leaf, hand_.colliders);
    internal::AppendVisuals(path_, source, X_LB, hand_.links[link]);
    if (leaf) SetTip(source, link, X_LB);
    for (const auto& joint : joints) {
      const urdf::Link& child = *urdf_->links_.at(joint->child_link_name);
      const Pose X_LJ = X_LB * OriginOf(*joint);
      if (joint->type == urdf::Joint::FIXED)
        Visit(child, link, X_LJ);
      else
        Visit(child, AddJoint(*joint, link, X_LJ), Pose());
    }
  }

  void AbsorbMass(const urdf::Link& source, int link, const Pose& X_LB) {
    if (source.inertial == nullptr) return;
    const urdf::Inertial& from = *source.inertial;
    const Pose X_LI = X_LB * PoseOf(from.origin);
    Eigen::Matrix3d I;
    I << from.ixx, from.ixy, from.ixz, from.ixy, from.iyy, from.iyz, from.ixz, from.iyz, from.izz;
    if (!I.allFinite() || !std::isfinite(from.mass) || !X_LI.p.allFinite() || from.mass < 0)
      Fail("{}: link '{}': inertial: expected finite numbers and mass >= 0, found mass {}", path_,
           source.name, from.mass);
    const Eigen::Matrix3d R = X_LI.q.toRotationMatrix();
    AddMass(from.mass, X_LI.p, R * I * R.transpose(), hand_.links[link]);
  }

  void CheckMass(const Link& link) const {
    const Eigen::Vector3d moments = link.inertia.selfadjointView<Eigen::Lower>().eigenvalues();
    if (!(link.mass > 0) || !(moments.minCoeff() > 0))
      Fail(
          "{}: link '{}': inertial: expected mass > 0 and a positive definite inertia, found mass "
          "{} kg and smallest moment {} kg m^2",
          path_, link.name, link.mass, moments.minCoeff());
  }

  Pose OriginOf(const urdf::Joint& joint) const {
    const Pose pose = PoseOf(joint.parent_to_joint_origin_transform);
    if (!pose.p.allFinite() || !pose.q.coeffs().allFinite())
      Fail("{}: joint '{}': origin: expected finite numbers", path_, joint.name);
    return pose;
  }

  // Returns the index of the link that the joint moves.
  int AddJoint(const urdf::Joint& source, int parent, const Pose& X_PJ) {
    if (source.type != urdf::Joint::REVOLUTE)
      Fail("{}: joint '{}': expected type revolute or fixed, found another", path_, source.name);
    const bool first = parent == 0;
    for (const Joint& other : hand_.joints)
      if (!first && other.parent == parent)
        Fail("{}: joint '{}': expected serial chains, found link '{}' carrying '{}' too", path_,
             source.name, hand_.links[parent].name, other.name);
    Joint joint;
    joint.name = source.name;
    joint.parent = parent;
    joint.child = static_cast<int>(hand_.links.size());
    joint.X_PJ = X_PJ;
    joint.axis = {source.axis.x, source.axis.y, source.axis.z};
    if (!(std::abs(joint.axis.norm() - 1) < 1e-6))
      Fail("{}: joint '{}': axis: expected a unit vector, found {} {} {}", path_, source.name,
           source.axis.x, source.axis.y, source.axis.z);
    ReadLimits(source, joint);
    if (first) {
      hand_.chains.emplace_back();
      hand_.tip_frames.emplace_back();
    }
    const int chain = first ? static_cast<int>(hand_.chains.size()) - 1 : hand_.links[parent].chain;
    hand_.chains[chain].push_back(joint.child - 1);
    hand_.joints.push_back(joint);
    Link& link = hand_.links.emplace_back();
    link.name = source.child_link_name;
    link.parent = parent;
    link.chain = chain;
    return joint.child;
  }

  void ReadLimits(const urdf::Joint& source, Joint& joint) const {
    if (source.limits == nullptr)
      Fail("{}: joint '{}': limit: expected lower, upper, effort, velocity, found none", path_,
           source.name);
    const urdf::JointLimits& limits = *source.limits;
    if (!(limits.lower < limits.upper) || !std::isfinite(limits.upper - limits.lower))
      Fail("{}: joint '{}': limit: expected lower < upper, found {} and {}", path_, source.name,
           limits.lower, limits.upper);
    if (!(limits.effort > 0) || !(limits.velocity > 0))
      Fail("{}: joint '{}': limit: expected effort and velocity > 0, found {} and {}", path_,
           source.name, limits.effort, limits.velocity);
    joint.lower = limits.lower;
    joint.upper = limits.upper;
    // NOTE(paper): silent; the hand's own URDF holds placeholders, so the motor's figures bound it.
    joint.torque_limit = std::min(limits.effort, options_.torque_limit);
    joint.speed_limit = std::min(limits.velocity, options_.speed_limit);
  }

  void SetTip(const urdf::Link& source, int link, const Pose& X_LB) {
    const int chain = hand_.links[link].chain;
    if (tips_.contains(chain))
      Fail("{}: link '{}': expected one tip per finger, found a second beside '{}'", path_,
           source.name, tips_.at(chain));
    tips_[chain] = source.name;
    hand_.tip_frames[chain] = X_LB;
  }

  const HandOptions& options_;
  std::string path_;
  urdf::ModelInterfaceSharedPtr urdf_;
  HandModel hand_;
  std::set<std::string> seen_;
  std::map<int, std::string> tips_;
};

}  // namespace

HandModel LoadHand(const HandOptions& options) { return Loader(options).Load(); }

}  // namespace dexremoe
