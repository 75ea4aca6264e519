#include "policy/policy_net.h"

#include "base/check.h"
#include "nn/kernels.h"
#include "nn/precision.h"

namespace dexremoe {
namespace {

template <typename T>
class StoredNet final : public PolicyNet {
 public:
  StoredNet(const PolicyStructure& structure, int workers)
      : policy_(MakePolicy<T>(structure)), params_(policy_->layout().size()), work_(workers) {}

  void Load(const std::vector<float>& params) override {
    DEX_CHECK_EQ(params.size(), params_.size());
    Cast(static_cast<std::int64_t>(params.size()), params.data(), params_.data());
  }
  void Freeze(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
              float* frozen) override {
    policy_->Freeze(params_.data(), shapes, rows, work_[worker], frozen);
  }
  void Forward(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
               float* mean, float* value) override {
    policy_->Forward(params_.data(), shapes, rows, work_[worker], mean, value);
  }
  void Balance(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
               float weight, RoutingSums& sums) override {
    policy_->Balance(rows, shapes, work_[worker], weight, sums);
  }
  void Backward(int worker, const ShapeInputs<float>& shapes, const PolicyRows<float>& rows,
                const float* dmean, const float* dvalue, float* grads) override {
    policy_->Backward(params_.data(), shapes, rows, work_[worker], dmean, dvalue, grads);
  }

 private:
  std::unique_ptr<Policy<T>> policy_;
  std::vector<T> params_;
  std::vector<Workspace<T>> work_;  // per worker
};

}  // namespace

std::unique_ptr<PolicyNet> MakePolicyNet(const PolicyStructure& structure, int workers) {
  if (ResolvePrecision(structure.precision) == "bf16")
    return std::make_unique<StoredNet<BFloat16>>(structure, workers);
  return std::make_unique<StoredNet<float>>(structure, workers);
}

}  // namespace dexremoe
