#include "nn/mlp.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "nn/layers.h"
#include "nn/normalizer.h"

namespace dexremoe {
namespace {

// Rows that go through all layers together: their activations stay in the processor's cache.
constexpr std::int64_t kBlockRows = 512;

}  // namespace

Mlp::Mlp(ParamLayout& layout, const std::string& name, std::vector<int> widths, bool activate_end,
         Activation activation)
    : widths_(std::move(widths)), activate_end_(activate_end), activation_(activation) {
  DEX_CHECK_GE(widths_.size(), 2u);
  first_block_ = static_cast<int>(layout.blocks().size());
  for (int layer = 0; layer < layers(); ++layer) {
    const std::string prefix = name + "/" + std::to_string(layer);
    const int outputs = widths_[layer + 1];
    weight_offset_.push_back(
        layout.block(layout.Add(prefix + "/weight", outputs, widths_[layer])).offset);
    bias_offset_.push_back(layout.block(layout.Add(prefix + "/bias", outputs, 1)).offset);
  }
}

std::int64_t Mlp::ActivationSize(std::int64_t n) const {
  std::int64_t columns = 0;
  for (std::size_t i = 1; i < widths_.size(); ++i) columns += widths_[i];
  return n * columns;
}

// Gradients of two neighbouring hidden layers of one block, used in turn.
std::int64_t Mlp::ScratchSize(std::int64_t n) const {
  int widest = 0;
  for (std::size_t i = 1; i + 1 < widths_.size(); ++i) widest = std::max(widest, widths_[i]);
  return 2 * std::min(n, kBlockRows) * widest;
}

template <typename T>
const T* Mlp::Forward(const T* params, std::int64_t n, const T* x, T* activations) const {
  for (std::int64_t row = 0; row < n; row += kBlockRows)
    ForwardBlock<T>(params, n, row, std::min(kBlockRows, n - row), x, activations);
  return activations + ActivationSize(n) - n * outputs();
}

template <typename T>
void Mlp::ForwardBlock(const T* params, std::int64_t n, std::int64_t row, std::int64_t rows,
                       const T* x, T* activations) const {
  const T* input = x + row * inputs();
  T* layer_output = activations;
  for (int layer = 0; layer < layers(); ++layer) {
    const int columns = widths_[layer + 1];
    T* y = layer_output + row * columns;
    LinearActivate<T>(After(layer), rows, widths_[layer], columns, input,
                      params + weight_offset_[layer], params + bias_offset_[layer], y);
    input = y;
    layer_output += n * columns;
  }
}

template <typename T>
void Mlp::Backward(const T* params, std::int64_t n, const T* x, const T* activations, T* dy, T* dx,
                   Wide<T>* grads, T* scratch, std::int64_t first) const {
  for (std::int64_t row = 0; row < n; row += kBlockRows)
    BackwardBlock<T>(params, n, row, std::min(kBlockRows, n - row), x, activations,
                     dy + row * outputs(), dx != nullptr ? dx + row * (inputs() - first) : nullptr,
                     grads, scratch, first);
}

// dy and dx are the block's.
template <typename T>
void Mlp::BackwardBlock(const T* params, std::int64_t n, std::int64_t row, std::int64_t rows,
                        const T* x, const T* activations, T* dy, T* dx, Wide<T>* grads, T* scratch,
                        std::int64_t first) const {
  const T* layer_output = activations + ActivationSize(n);  // one past the last layer's
  T* const halves[2] = {scratch, scratch + ScratchSize(n) / 2};
  for (int layer = layers() - 1; layer >= 0; --layer) {
    const int inputs = widths_[layer], outputs = widths_[layer + 1];
    layer_output -= n * outputs;
    ActivationBackward<T>(After(layer), rows * outputs, layer_output + row * outputs, dy, dy);
    const T* input = (layer > 0 ? layer_output - n * inputs : x) + row * inputs;
    T* dinput = layer > 0 ? halves[layer % 2] : dx;
    LinearBackward<T>(rows, inputs, outputs, input, params + weight_offset_[layer], dy, dinput,
                      grads != nullptr ? grads + weight_offset_[layer] : nullptr,
                      grads != nullptr ? grads + bias_offset_[layer] : nullptr,
                      layer > 0 ? 0 : first);
    dy = dinput;
  }
}

void Mlp::InitializeLayer(Rng& rng, int layer, double bound, float* params) const {
  float* weight = params + weight_offset_[layer];
  const std::int64_t inputs = widths_[layer], outputs = widths_[layer + 1];
  for (std::int64_t i = 0; i < inputs * outputs; ++i)
    weight[i] = static_cast<float>(rng.Uniform(-bound, bound));
  float* bias = params + bias_offset_[layer];
  for (std::int64_t i = 0; i < outputs; ++i) bias[i] = 0;
}

void Mlp::Initialize(Rng& rng, double last_scale, float* params) const {
  for (int layer = 0; layer < layers(); ++layer) {
    const double scale = layer + 1 == layers() ? last_scale : 1.0;
    InitializeLayer(rng, layer, scale / std::sqrt(widths_[layer]), params);
  }
}

void Mlp::InitializeHe(Rng& rng, float* params) const {
  for (int layer = 0; layer < layers(); ++layer)
    InitializeLayer(rng, layer, std::sqrt(6.0 / widths_[layer]), params);
}

void Mlp::NormalizeOnData(std::int64_t n, const float* x, float* params) const {
  std::vector<float> input(x, x + n * inputs()), output;
  for (int layer = 0; layer < layers(); ++layer) {
    const std::int64_t columns = widths_[layer + 1], wide = widths_[layer];
    float* weight = params + weight_offset_[layer];
    float* bias = params + bias_offset_[layer];
    output.resize(n * columns);
    std::fill(bias, bias + columns, 0.0f);
    LinearForward<float>(n, wide, columns, input.data(), weight, bias, output.data());
    RunningMoments moments(static_cast<int>(columns));
    moments.count = 0;
    UpdateMoments(n, output.data(), moments);
    for (std::int64_t j = 0; j < columns; ++j) {
      const double deviation = std::sqrt(moments.variance[j]);
      const double scale = deviation > 1e-6 ? 1 / deviation : 1.0;
      for (std::int64_t i = 0; i < wide; ++i)
        weight[j * wide + i] = static_cast<float>(weight[j * wide + i] * scale);
      bias[j] = static_cast<float>(-moments.mean[j] * scale);
    }
    LinearActivate<float>(activation_, n, wide, columns, input.data(), weight, bias, output.data());
    input.swap(output);
  }
}

#define DEX_INSTANTIATE(T)                                                                      \
  template const T* Mlp::Forward(const T*, std::int64_t, const T*, T*) const;                   \
  template void Mlp::Backward(const T*, std::int64_t, const T*, const T*, T*, T*, Wide<T>*, T*, \
                              std::int64_t) const;
DEX_INSTANTIATE(BFloat16)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
