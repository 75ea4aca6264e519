#include "sim/lanes/lanes_model.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "base/error.h"
#include "sim/lanes/hand_cores.h"
#include "sim/lanes/object_field.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// How far beyond the largest core's radius a field reaches from the object's box.
constexpr double kFieldMargin = 6e-3;  // m

void Put(const Vector3d& v, float* out) {
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

void Put(const Matrix3d& m, float* out) {
  for (int c = 0; c < 3; ++c) Put(Vector3d(m.col(c)), out + 3 * c);
}

// The rotation R_LZ of a frame Z whose +z is the joint's axis in L.
Matrix3d AxisFrame(const Vector3d& axis) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
}

void CheckSizes(const HandModel& hand) {
  const auto check = [&](const char* what, std::size_t found, int most) {
    if (found > static_cast<std::size_t>(most))
      Fail("{}: {}: the lanes engine takes at most {}, found {}", hand.source, what, most, found);
  };
  check("joints", hand.joints.size(), kMaxJoints);
  check("fingers", hand.chains.size(), kMaxChains);
  for (const auto& chain : hand.chains) check("joints of a finger", chain.size(), kMaxChainJoints);
}

LaneLink MakeLink(const HandModel& hand, int j, const Matrix3d& R_parent, const Matrix3d& R_own) {
  const Joint& joint = hand.joints[j];
  const Link& link = hand.links[joint.child];
  if (!(link.mass > 0)) Fail("link {}: mass: expected > 0 kg, found {}", link.name, link.mass);
  LaneLink out;
  Put(Matrix3d(R_parent.transpose() * joint.X_PJ.q.toRotationMatrix() * R_own), out.R_PL);
  Put(Vector3d(R_parent.transpose() * joint.X_PJ.p), out.p_PL);
  out.mass = static_cast<float>(link.mass);
  Put(Vector3d(R_own.transpose() * link.com), out.com);
  const Matrix3d I = R_own.transpose() * link.inertia * R_own;
  const double unique[6] = {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
  std::copy(unique, unique + 6, out.inertia);
  out.lower = static_cast<float>(joint.lower);
  out.upper = static_cast<float>(joint.upper);
  out.torque_limit = static_cast<float>(joint.torque_limit);
  out.speed_limit = static_cast<float>(joint.speed_limit);
  return out;
}

// Fills chains and links; returns R_LZ of every link of the hand.
std::vector<Matrix3d> AddChains(const HandModel& hand, LanesModel& model) {
  std::vector<Matrix3d> R_LZ(hand.links.size(), Matrix3d::Identity());
  for (const Joint& joint : hand.joints) R_LZ[joint.child] = AxisFrame(joint.axis);
  for (const std::vector<int>& joints : hand.chains) {
    model.chains.push_back({static_cast<int>(model.links.size()), static_cast<int>(joints.size())});
    for (const int j : joints) {
      const Joint& joint = hand.joints[j];
      model.links.push_back(MakeLink(hand, j, R_LZ[joint.parent], R_LZ[joint.child]));
      model.joint_of.push_back(j);
    }
  }
  return R_LZ;
}

LaneCore MakeCore(const HandModel& hand, const RoundedCore& core, const Matrix3d& R_LZ) {
  LaneCore out;
  out.chain = hand.links[core.link].chain;
  out.link = -1;
  if (out.chain >= 0) {
    const std::vector<int>& joints = hand.chains[out.chain];
    const auto at = std::find_if(joints.begin(), joints.end(),
                                 [&](int j) { return hand.joints[j].child == core.link; });
    out.link = static_cast<int>(at - joints.begin());
  }
  out.extents = static_cast<int>((core.half.array() > 0).count());
  Put(Vector3d(R_LZ.transpose() * core.center), out.center);
  Put(Matrix3d(R_LZ.transpose() * core.axes), out.axes);
  Put(core.half, out.half);
  out.radius = static_cast<float>(core.radius);
  out.tip = core.fingertip;
  return out;
}

// Fingertips of different fingers, and tips against the palm, as in the other engines.
void AddPairs(const HandModel& hand, LanesModel& model) {
  const int count = static_cast<int>(model.cores.size());
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < count; ++b) {
      const LaneCore &tip = model.cores[a], &other = model.cores[b];
      const bool tips = other.tip && tip.chain < other.chain;
      const bool palm = other.chain < 0 && tip.chain >= 0 && hand.chains[tip.chain].size() > 1;
      if (tip.tip && tip.extents <= 1 && ((tips && other.extents <= 1) || palm))
        model.pairs.push_back({a, b});
    }
  std::stable_sort(model.pairs.begin(), model.pairs.end(),
                   [&](const LaneCorePair& l, const LaneCorePair& r) {
                     const auto key = [&](const LaneCorePair& p) {
                       return std::array<int, 2>{model.cores[p.a].chain, model.cores[p.b].chain};
                     };
                     return key(l) < key(r);
                   });
}

// A ball around the tip's cores, about the mean of their centres.
void SetTipBall(const std::vector<LaneCore>& cores, int c, LaneChain& chain) {
  const auto vector = [](const float* v) { return Vector3d(v[0], v[1], v[2]); };
  Vector3d center = Vector3d::Zero();
  int count = 0;
  for (const LaneCore& core : cores)
    if (core.tip && core.chain == c) center += vector(core.center), ++count;
  if (count == 0) return;
  center /= count;
  double radius = 0;
  for (const LaneCore& core : cores)
    if (core.tip && core.chain == c)
      radius = std::max(
          radius, (vector(core.center) - center).norm() + vector(core.half).norm() + core.radius);
  Put(center, chain.tip_center);
  chain.tip_radius = static_cast<float>(radius);
}

void AddCores(const HandModel& hand, const std::vector<Matrix3d>& R_LZ, LanesModel& model) {
  for (const RoundedCore& core : CoresOf(hand))
    model.cores.push_back(MakeCore(hand, core, R_LZ[core.link]));
  const auto group = [&](const LaneCore& core) {
    return core.chain < 0 ? static_cast<int>(model.chains.size()) : core.chain;
  };
  std::stable_sort(model.cores.begin(), model.cores.end(),
                   [&](const LaneCore& a, const LaneCore& b) { return group(a) < group(b); });
  for (std::size_t c = 0; c < model.chains.size(); ++c)
    SetTipBall(model.cores, static_cast<int>(c), model.chains[c]);
  AddPairs(hand, model);
}

// Turns the parts into the principal axes of inertia; objects whose axes are principal already, or
// that have no distinct ones, keep theirs.
LaneObject MakeObject(const SimObject& object) {
  LaneObject out;
  const Matrix3d& I = object.unit_inertia;
  const double off = std::max({std::abs(I(0, 1)), std::abs(I(0, 2)), std::abs(I(1, 2))});
  out.unit_inertia = I.diagonal();
  if (off > 1e-6 * I.trace()) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(I);
    Matrix3d R_OB = solver.eigenvectors();
    if (R_OB.determinant() < 0) R_OB.col(2) *= -1;
    out.q_OB = Eigen::Quaterniond(R_OB);
    out.turned = true;
    out.unit_inertia = solver.eigenvalues();
  }
  if (!(out.unit_inertia.minCoeff() > 0))
    Fail("object {}: inertia: expected a positive definite matrix", object.name);
  for (const TriMesh& part : object.parts)
    for (const Vector3d& vertex : part.vertices) {
      out.radius = std::max(out.radius, vertex.norm());
      out.box.Extend(out.q_OB.conjugate() * vertex);
    }
  return out;
}

ObjectField MakeField(const SimObject& object, const Matrix3d& R_OB, double margin) {
  ConvexParts parts = object.parts;
  for (TriMesh& part : parts)
    for (Vector3d& vertex : part.vertices) vertex = R_OB.transpose() * vertex;
  return BuildObjectField(parts, margin);
}

void AddObjects(const std::vector<SimObject>& objects, ThreadPool& pool, LanesModel& model) {
  double margin = 0;
  for (const LaneCore& core : model.cores) margin = std::max<double>(margin, core.radius);
  margin += kFieldMargin;
  const std::size_t nodes = objects.size() * static_cast<std::size_t>(kFieldSize);
  if (nodes > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max() / 2))
    Fail("lanes engine: {} objects: their distance fields have too many nodes", objects.size());
  model.nodes = BigArray<std::int16_t>(nodes + 2);  // pairs are read
  model.objects.resize(objects.size());
  pool.ParallelFor(static_cast<int>(objects.size()), [&](int i, int) {
    LaneObject& object = model.objects[i] = MakeObject(objects[i]);
    const ObjectField field = MakeField(objects[i], object.q_OB.toRotationMatrix(), margin);
    object.first_node = i * kFieldSize;
    object.origin = field.origin.cast<double>();
    object.spacing = field.spacing.cast<double>();
    object.quantum = field.quantum;
    std::copy(field.nodes.begin(), field.nodes.end(), &model.nodes[object.first_node]);
  });
}

}  // namespace

LanesModel MakeLanesModel(const SimOptions& options, const HandModel& hand,
                          const std::vector<SimObject>& objects, ThreadPool& pool) {
  CheckSizes(hand);
  LanesModel model;
  model.kp = hand.kp;
  model.kd = hand.kd;
  model.armature = static_cast<float>(hand.armature);
  model.substeps = options.substeps;
  model.inner_steps = options.inner_steps;
  model.iterations = options.iterations;
  model.substep = static_cast<float>(1 / (options.control_rate * options.substeps));
  AddCores(hand, AddChains(hand, model), model);
  model.layout = BlockLayout(hand.num_joints(), static_cast<int>(hand.chains.size()),
                             static_cast<int>(model.cores.size()));
  AddObjects(objects, pool, model);
  return model;
}

}  // namespace dexremoe
