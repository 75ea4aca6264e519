#include "rl/inference.h"

#include <algorithm>

namespace dexremoe {
namespace {

constexpr std::int64_t kBlock = 256;  // rows; small enough to share 512 environments on two cores

}  // namespace

Inference::Inference(const Policy<float>& policy, ThreadPool& pool)
    : policy_(policy),
      pool_(pool),
      net_(MakePolicyNet(policy.structure(), pool.workers())),
      scratch_(pool.workers()) {
  for (Scratch& scratch : scratch_) {
    scratch.mean.resize(kBlock * policy.structure().num_actions);
    scratch.value.resize(kBlock);
    scratch.frozen.resize(kBlock * policy.frozen_size());
  }
}

void Inference::Run(const std::vector<float>& params, const ShapeInputs<float>& shapes,
                    const PolicyRows<float>& rows, const InferenceOutput& out) {
  net_->Load(params);
  const int blocks = static_cast<int>((rows.n + kBlock - 1) / kBlock);
  pool_.ParallelFor(
      blocks, [&](int block, int worker) { RunBlock(worker, shapes, rows, out, block * kBlock); });
}

void Inference::RunBlock(int worker, const ShapeInputs<float>& shapes,
                         const PolicyRows<float>& rows, const InferenceOutput& out,
                         std::int64_t begin) {
  Scratch& scratch = scratch_[worker];
  const PolicyStructure& s = policy_.structure();
  const std::int64_t frozen_size = policy_.frozen_size();
  PolicyRows<float> block;
  block.n = std::min(kBlock, rows.n - begin);
  block.obs = rows.obs + begin * s.obs_size;
  block.phys = rows.phys + begin * s.phys_size;
  block.object = rows.object + begin;
  if (rows.noise != nullptr) block.noise = rows.noise + begin * policy_.noise_size();
  if (frozen_size > 0) {
    float* frozen =
        out.frozen != nullptr ? out.frozen + begin * frozen_size : scratch.frozen.data();
    net_->Freeze(worker, shapes, block, frozen);
    block.frozen = frozen;
  }
  net_->Forward(worker, shapes, block,
                out.mean != nullptr ? out.mean + begin * s.num_actions : scratch.mean.data(),
                out.value != nullptr ? out.value + begin : scratch.value.data());
}

}  // namespace dexremoe
