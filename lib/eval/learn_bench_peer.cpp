#include "eval/learn_bench_peer.h"

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <vector>

#include "base/error.h"
#include "eval/peer_program.h"

namespace dexremoe {
namespace {

constexpr std::size_t kFields = 7;

}  // namespace

PeerUpdate ParsePeer(const std::string& program, const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream text(line.substr(0, line.find('\n')));
  for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
  if (fields.size() != kFields)
    Fail("{}: output: expected a line of {} fields, found '{}'", program, kFields, line);
  const auto number = [&](std::size_t i) {
    char* end = nullptr;
    const double value = std::strtod(fields[i].c_str(), &end);
    if (*end != '\0' || !(value > 0) || !std::isfinite(value))
      Fail("{}: output: field {}: expected a positive number, found '{}'", program, i + 1,
           fields[i]);
    return value;
  };
  return {fields[0], fields[1], number(2), number(4), number(5), number(6)};
}

PeerUpdate RunPeer(const std::string& program, const PpoOptions& ppo, const PolicyOptions& policy,
                   int workers, double seconds) {
  std::string hidden;
  for (int layer = 0; layer < policy.layers; ++layer)
    hidden += fmt::format("{}{}", layer > 0 ? "," : "", policy.hidden);
  // The libraries below libtorch read their number of threads when they are loaded.
  return ParsePeer(
      program,
      OutputOf(program,
               fmt::format("OMP_NUM_THREADS={0} OPENBLAS_NUM_THREADS={0} {1} --workers={0} "
                           "--envs={2} --horizon={3} --minibatch={4} --mini_epochs={5} "
                           "--hidden={6} --precision={7} --seconds={8}",
                           workers, ShellQuoted(program), ppo.envs, ppo.horizon, ppo.minibatch,
                           ppo.mini_epochs, hidden, ppo.precision, seconds)));
}

}  // namespace dexremoe
