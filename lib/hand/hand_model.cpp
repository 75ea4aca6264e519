#include "hand/hand_model.h"

namespace dexremoe {

void HandOptions::Register(Options& options) {
  options.Add("hand.urdf", &urdf, "hand description (URDF)");
  // A shorter name for the same; registered later, so it wins over a configuration file.
  options.Add("hand", &urdf, "short for --hand.urdf").NotStored();
  options.Add("hand.kp", &kp, "servo stiffness, N m/rad").Range(0, 100);
  options.Add("hand.kd", &kd, "servo damping, N m s/rad").Range(0, 10);
  options.Add("hand.torque_limit", &torque_limit, "N m; the URDF's effort when smaller")
      .Range(1e-6, 100);
  options.Add("hand.speed_limit", &speed_limit, "rad/s; the URDF's velocity when smaller")
      .Range(1e-6, 1000);
  options.Add("hand.armature", &armature, "reflected inertia of a motor, kg m^2").Range(0, 1);
}

std::vector<Pose> ForwardKinematics(const HandModel& hand, const double* q) {
  std::vector<Pose> X_WL(hand.links.size());
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[j];
    const Pose turn{Eigen::Quaterniond(Eigen::AngleAxisd(q[j], joint.axis)),
                    Eigen::Vector3d::Zero()};
    X_WL[joint.child] = X_WL[joint.parent] * joint.X_PJ * turn;
  }
  return X_WL;
}

}  // namespace dexremoe
