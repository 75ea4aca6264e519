#include "task/grasp_file.h"

#include <cmath>

#include "base/check.h"
#include "base/error.h"

namespace dexremoe {

void WriteGrasps(const std::string& path, const GraspSet& set, const Provenance& provenance) {
  std::vector<double> q, target, position, rotation, scale;
  const std::size_t joints = set.grasps.empty() ? 0 : set.grasps.front().q.size();
  for (const Grasp& g : set.grasps) {
    DEX_CHECK_EQ(g.q.size(), joints);
    DEX_CHECK_EQ(g.target.size(), joints);
    q.insert(q.end(), g.q.begin(), g.q.end());
    target.insert(target.end(), g.target.begin(), g.target.end());
    position.insert(position.end(), g.X_WO.p.begin(), g.X_WO.p.end());
    const Eigen::Quaterniond& r = g.X_WO.q;
    rotation.insert(rotation.end(), {r.w(), r.x(), r.y(), r.z()});
    scale.push_back(g.scale);
  }
  const auto G = static_cast<std::int64_t>(set.grasps.size());
  const auto J = static_cast<std::int64_t>(joints);
  H5Writer file(path, kGraspsFormat, provenance);
  file.Write("joint_position", q, {G, J}, {"rad", "grasp, joint", "joint angles at rest"});
  file.Write("joint_target", target, {G, J}, {"rad", "grasp, joint", "servo targets that hold it"});
  file.Write("object_position", position, {G, 3}, {"m", "grasp, xyz", "centre of mass in W"});
  file.Write("object_rotation", rotation, {G, 4}, {"1", "grasp, wxyz", "unit quaternion q_WO"});
  file.Write("scale", scale, {G}, {"1", "grasp", "size factor of the object"});
  file.WriteScalar("acceptance", set.acceptance, {"1", "", "kept / tried candidates"});
  file.Commit();
}

GraspSet ReadGrasps(const std::string& path) {
  const H5Reader file(path, kGraspsFormat);
  const H5Array<double> q = file.Read<double>("joint_position", {-1, -1});
  const std::int64_t G = q.dims[0], J = q.dims[1];
  const std::vector<double> target = file.ReadValues<double>("joint_target", {G, J});
  const std::vector<double> position = file.ReadValues<double>("object_position", {G, 3});
  const std::vector<double> rotation = file.ReadValues<double>("object_rotation", {G, 4});
  const std::vector<double> scale = file.ReadValues<double>("scale", {G});
  GraspSet set;
  set.acceptance = file.ReadScalar<double>("acceptance");
  for (std::int64_t g = 0; g < G; ++g) {
    Grasp grasp;
    grasp.q.assign(q.values.begin() + g * J, q.values.begin() + (g + 1) * J);
    grasp.target.assign(target.begin() + g * J, target.begin() + (g + 1) * J);
    const double* p = &position[g * 3];
    const double* r = &rotation[g * 4];
    grasp.X_WO = {Eigen::Quaterniond(r[0], r[1], r[2], r[3]), Eigen::Vector3d(p[0], p[1], p[2])};
    grasp.scale = scale[g];
    if (!(std::abs(grasp.X_WO.q.norm() - 1) < 1e-6))
      Fail("{}: object_rotation: expected unit quaternions, found norm {} in row {}", path,
           grasp.X_WO.q.norm(), g);
    set.grasps.push_back(std::move(grasp));
  }
  return set;
}

}  // namespace dexremoe
