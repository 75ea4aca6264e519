#include "rl/gae.h"

#include "base/check.h"

namespace dexremoe {

void ComputeGae(int steps, int envs, double gamma, double lambda, const std::vector<float>& reward,
                const std::vector<std::uint8_t>& done, const std::vector<float>& value,
                const std::vector<float>& last_value, std::vector<float>& advantage,
                std::vector<float>& target) {
  const std::size_t rows = static_cast<std::size_t>(steps) * envs;
  DEX_CHECK_EQ(reward.size(), rows);
  DEX_CHECK_EQ(done.size(), rows);
  DEX_CHECK_EQ(value.size(), rows);
  DEX_CHECK_EQ(last_value.size(), static_cast<std::size_t>(envs));
  advantage.resize(rows);
  target.resize(rows);
  for (int env = 0; env < envs; ++env) {
    double next_value = last_value[env];
    double next_advantage = 0;
    for (int t = steps - 1; t >= 0; --t) {
      const std::size_t row = static_cast<std::size_t>(t) * envs + env;
      const double on = done[row] ? 0.0 : 1.0;
      const double delta = reward[row] + on * gamma * next_value - value[row];
      next_advantage = delta + on * gamma * lambda * next_advantage;
      next_value = value[row];
      advantage[row] = static_cast<float>(next_advantage);
      target[row] = static_cast<float>(next_advantage + next_value);
    }
  }
}

}  // namespace dexremoe
