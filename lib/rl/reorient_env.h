// The real task behind the interface that training uses.
#pragma once

#include "rl/env.h"

namespace dexremoe {

class ReorientEnv final : public VecEnv {
 public:
  // `batch` must outlive this.
  explicit ReorientEnv(ReorientBatch& batch)
      : batch_(batch), c_fall_(batch.mutable_options().c_fall) {}

  int num_envs() const override { return batch_.num_envs(); }
  int first_env() const override { return batch_.first_env(); }
  int obs_size() const override { return batch_.obs_size(); }
  int phys_size() const override { return batch_.phys_size(); }
  int num_actions() const override { return batch_.num_joints(); }
  void ResetAll() override { batch_.ResetAll(); }
  const StepResult& Step(const std::vector<float>& actions) override {
    return batch_.Step(actions);
  }
  const std::vector<float>& obs() const override { return batch_.obs(); }
  const std::vector<float>& phys() const override { return batch_.phys(); }
  const std::vector<int>& object() const override { return batch_.object(); }
  std::vector<EpisodeRecord> TakeRecords() override { return batch_.TakeRecords(); }
  void SetDifficulty(const TaskDifficulty& difficulty) override {
    batch_.mutable_options().goal_angle = difficulty.goal_angle;
    batch_.mutable_options().velocity_tolerance = difficulty.velocity_tolerance;
    batch_.mutable_options().gravity_factor = difficulty.gravity_factor;
    batch_.mutable_options().objects_in_use = difficulty.objects;
    batch_.mutable_options().near_share = difficulty.near_share;
    batch_.mutable_options().c_fall = difficulty.fall_share * c_fall_;
  }
  void SetRandomRanges(const std::vector<double>& low, const std::vector<double>& high) override {
    for (int i = 0; i < kNumRandom; ++i)
      batch_.mutable_options().random.range[i] = {low[i], high[i]};
  }
  std::vector<std::uint8_t> Save() const override { return batch_.Save(); }
  void Restore(const std::vector<std::uint8_t>& bytes) override { batch_.Restore(bytes); }

 private:
  ReorientBatch& batch_;
  const double c_fall_;  // the task's
};

}  // namespace dexremoe
