// A simulator that does what the test says: joints go to their targets, objects where scripted.
#pragma once

#include <algorithm>
#include <functional>

#include "base/bytes.h"
#include "sim/batch_sim.h"

namespace dexremoe {

class FakeSim final : public BatchSim {
 public:
  FakeSim(int num_envs, int joints, int fingers) : joints_(joints), fingers_(fingers) {
    const std::size_t n = num_envs;
    state_.joint_position.resize(n * joints);
    state_.joint_velocity.resize(n * joints);
    state_.object_position.resize(n * 3);
    state_.object_rotation.resize(n * 4);
    state_.object_velocity.resize(n * 3);
    state_.object_spin.resize(n * 3);
    state_.tip_contact.resize(n * fingers);
    state_.contact_count.resize(n);
    state_.max_penetration.resize(n);
    object.resize(n);
    physics.resize(n);
    steps.resize(n);
  }

  // Called for each stepped environment after its joints took their targets.
  std::function<void(int env, EnvState& state)> script;
  std::vector<int> object, steps;
  std::vector<EnvPhysics> physics;
  std::vector<std::pair<int, Eigen::Vector3d>> pushes;

  int num_envs() const override { return static_cast<int>(object.size()); }
  int num_joints() const override { return joints_; }
  const SimState& state() const override { return state_; }
  void SetObject(int env, int index, const EnvPhysics& p) override {
    object[env] = index;
    physics[env] = p;
  }
  void SetState(int env, const EnvState& s) override {
    std::copy(s.q.begin(), s.q.end(), &state_.joint_position[env * joints_]);
    std::copy_n(s.X_WO.p.data(), 3, &state_.object_position[env * 3]);
    const double q[] = {s.X_WO.q.w(), s.X_WO.q.x(), s.X_WO.q.y(), s.X_WO.q.z()};
    std::copy_n(q, 4, &state_.object_rotation[env * 4]);
  }
  std::vector<std::uint8_t> Save(int env) const override {
    ByteWriter out;
    const EnvState s = GetState(env);
    out.PutVector(s.q);
    for (const double x : {s.X_WO.p.x(), s.X_WO.p.y(), s.X_WO.p.z(), s.X_WO.q.w(), s.X_WO.q.x(),
                           s.X_WO.q.y(), s.X_WO.q.z()})
      out.Put(x);
    out.Put(steps[env]);
    return out.Take();
  }
  void Restore(int env, std::span<const std::uint8_t> bytes) override {
    ByteReader in(bytes);
    EnvState s;
    s.q = in.GetVector<double>();
    for (double& x : s.X_WO.p) x = in.Get<double>();
    const auto w = in.Get<double>(), x = in.Get<double>(), y = in.Get<double>(),
               z = in.Get<double>();
    s.X_WO.q = Eigen::Quaterniond(w, x, y, z);
    in.GetInto(steps[env]);
    in.Finish();
    SetState(env, s);
  }
  void SetHeld(int, bool) override {}
  void PushObject(int env, const Eigen::Vector3d& force) override {
    pushes.emplace_back(env, force);
  }
  void Step(std::span<const double> targets, std::span<const std::uint8_t> active) override {
    for (int env = 0; env < num_envs(); ++env) {
      if (!active.empty() && !active[env]) continue;
      ++steps[env];
      EnvState s = GetState(env);
      for (int j = 0; j < joints_; ++j) s.q[j] = targets[env * joints_ + j];
      if (script) script(env, s);
      SetState(env, s);
    }
  }

 private:
  int joints_, fingers_;
  SimState state_;
};

}  // namespace dexremoe
