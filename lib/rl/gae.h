// Generalised advantage estimation (Schulman et al. 2016, eq. 16).
#pragma once

#include <cstdint>
#include <vector>

namespace dexremoe {

// T steps of N environments, time-major: row t * N + env.
//   reward [T,N]      at a timeout it already holds gamma V(last state)
//   done [T,N]        1 when the episode ended with this step, for whatever reason
//   value [T,N]       V of the state before the step
//   last_value [N]    V of the state after the last step
// advantage [T,N] and target [T,N] = advantage + value are set.
void ComputeGae(int steps, int envs, double gamma, double lambda, const std::vector<float>& reward,
                const std::vector<std::uint8_t>& done, const std::vector<float>& value,
                const std::vector<float>& last_value, std::vector<float>& advantage,
                std::vector<float>& target);

}  // namespace dexremoe
