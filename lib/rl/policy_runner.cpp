#include "rl/policy_runner.h"

#include <cmath>

#include "base/check.h"
#include "base/random.h"
#include "policy/policy.h"
#include "policy/shape_table.h"
#include "rl/inference.h"
#include "rl/policy_file.h"

namespace dexremoe {

struct PolicyRunner::Impl {
  TrainState state;
  std::unique_ptr<Policy<float>> policy;
  std::unique_ptr<ShapeRows> shapes;
  std::unique_ptr<Inference> inference;
  std::vector<float> weights;
  std::vector<float> obs, phys;  // normalised

  std::vector<float> Weights(const ShapeRows& rows) const {
    std::vector<float> weights(rows.inputs().objects * policy->gates());
    Workspace<float> work;
    if (policy->gates() > 0)
      policy->GateWeights(state.params.data(), rows.inputs(), work, weights.data());
    return weights;
  }
};

PolicyRunner::PolicyRunner(const std::string& path, const std::vector<TaskObject>& objects,
                           ThreadPool& pool)
    : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  m.state = ReadPolicy(path);
  // Whatever it was trained in: a file gives the same actions on every machine.
  m.state.structure.precision = "f32";
  m.policy = MakePolicy<float>(m.state.structure);
  const ShapeTable table = MakeShapeTable(objects, m.state.structure.feature_size);
  m.shapes =
      std::make_unique<ShapeRows>(table, m.state.normalizers.feature, m.state.normalizers.clip,
                                  m.state.structure.num_categories);
  m.inference = std::make_unique<Inference>(*m.policy, pool);
  m.weights = m.Weights(*m.shapes);
}

PolicyRunner::~PolicyRunner() = default;

const std::string& PolicyRunner::kind() const { return impl_->state.structure.kind; }
int PolicyRunner::obs_size() const { return impl_->state.structure.obs_size; }
int PolicyRunner::phys_size() const { return impl_->state.structure.phys_size; }
int PolicyRunner::num_actions() const { return impl_->state.structure.num_actions; }
std::int64_t PolicyRunner::samples() const { return impl_->state.samples; }
int PolicyRunner::gates() const { return impl_->policy->gates(); }
const std::vector<float>& PolicyRunner::GateWeights() const { return impl_->weights; }

void PolicyRunner::Act(const std::vector<float>& obs, const std::vector<float>& phys,
                       const std::vector<int>& object, std::vector<float>& actions) {
  Impl& m = *impl_;
  const std::int64_t n = static_cast<std::int64_t>(object.size());
  DEX_CHECK_EQ(static_cast<std::int64_t>(obs.size()), n * obs_size());
  DEX_CHECK_EQ(static_cast<std::int64_t>(phys.size()), n * phys_size());
  for (const int k : object) DEX_CHECK(k >= 0 && k < m.shapes->inputs().objects);
  m.obs.resize(obs.size());
  m.phys.resize(phys.size());
  actions.resize(n * num_actions());
  Normalize(m.state.normalizers.obs, m.state.normalizers.clip, n, obs.data(), m.obs.data());
  Normalize(m.state.normalizers.phys, m.state.normalizers.clip, n, phys.data(), m.phys.data());
  m.inference->Run(m.state.params, m.shapes->inputs(),
                   {n, m.obs.data(), m.phys.data(), object.data(), nullptr},
                   {actions.data(), nullptr, nullptr});
}

void PolicyRunner::Sample(const std::vector<float>& obs, const std::vector<float>& phys,
                          const std::vector<int>& object, std::uint64_t seed, std::uint64_t t,
                          std::vector<float>& actions) {
  Act(obs, phys, object, actions);
  const Impl& m = *impl_;
  const float* log_std =
      m.state.params.data() + m.policy->layout().block(m.policy->log_std_block()).offset;
  for (std::size_t row = 0; row < object.size(); ++row) {
    Rng rng(seed, Stream::kAction, {t, row});
    for (int a = 0; a < num_actions(); ++a)
      actions[row * num_actions() + a] += static_cast<float>(std::exp(log_std[a]) * rng.Normal());
  }
}

std::vector<float> PolicyRunner::WeightsOf(const std::vector<float>& feature,
                                           const std::vector<int>& category) const {
  const Impl& m = *impl_;
  DEX_CHECK_EQ(feature.size(), category.size() * m.state.structure.feature_size);
  const ShapeTable table = {std::vector<std::string>(category.size()), feature, category, {}};
  const ShapeRows shapes(table, m.state.normalizers.feature, m.state.normalizers.clip,
                         m.state.structure.num_categories);
  return m.Weights(shapes);
}

}  // namespace dexremoe
