// The base policy of lib/policy (ActorCritic) on libtorch: the same layers, widths and activations.
#pragma once

#include <torch/torch.h>

#include <string>
#include <vector>

namespace torch_peer {

// Widths of the paper's base policy; see PolicyStructure in lib/policy/structure.h.
struct Sizes {
  int obs = 66, phys = 23, feature = 100, categories = 6, actions = 11;
  std::vector<int> cloud = {32, 32, 32};
  std::vector<int> extrinsics = {256, 128};
  int z = 66;
  std::vector<int> hidden = {512, 512};
};

// Rows of a minibatch: obs [n, obs], phys [n, phys], object [n] (int64, into the shapes).
struct Rows {
  torch::Tensor obs, phys, object;
};

// Of every object: feature [K, feature], category [K, categories], one-hot.
struct Shapes {
  torch::Tensor feature, category;
};

// Linear layers with ELU between them, and after the last one when asked for.
inline torch::nn::Sequential MakeMlp(int inputs, const std::vector<int>& widths,
                                     bool activate_end) {
  torch::nn::Sequential mlp;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    mlp->push_back(torch::nn::Linear(inputs, widths[i]));
    if (activate_end || i + 1 < widths.size())
      mlp->push_back(torch::nn::ELU(torch::nn::ELUOptions().inplace(true)));
    inputs = widths[i];
  }
  return mlp;
}

class PolicyImpl : public torch::nn::Module {
 public:
  explicit PolicyImpl(const Sizes& s) {
    std::vector<int> extrinsics = s.extrinsics;
    extrinsics.push_back(s.z);
    const int shape = s.cloud.back() + s.categories;
    cloud_ = register_module("cloud", MakeMlp(s.feature, s.cloud, false));
    extrinsics_ = register_module("extrinsics", MakeMlp(s.phys + shape, extrinsics, false));
    trunk_ = register_module("trunk", MakeMlp(s.obs + s.z, s.hidden, true));
    mean_ = register_module("mean", torch::nn::Linear(s.hidden.back(), s.actions));
    value_ = register_module("value", torch::nn::Linear(s.hidden.back(), 1));
    log_std = register_parameter("log_std", torch::zeros(s.actions));
  }

  struct Output {
    torch::Tensor mean, value;  // [n, actions], [n]
  };
  Output forward(const Shapes& shapes, const Rows& rows) {
    const auto shape = torch::cat({cloud_->forward(shapes.feature), shapes.category}, 1);
    const auto e = torch::cat({rows.phys, shape.index_select(0, rows.object)}, 1);
    const auto hidden = trunk_->forward(torch::cat({rows.obs, extrinsics_->forward(e)}, 1));
    return {mean_->forward(hidden), value_->forward(hidden).squeeze(1)};
  }

  torch::Tensor log_std;  // [actions]

 private:
  torch::nn::Sequential cloud_, extrinsics_, trunk_;
  torch::nn::Linear mean_ = nullptr, value_ = nullptr;
};
TORCH_MODULE(Policy);

}  // namespace torch_peer
