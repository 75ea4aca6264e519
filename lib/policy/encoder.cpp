#include "policy/encoder.h"

#include <algorithm>

namespace dexremoe {
namespace {

std::vector<int> Widths(int inputs, const std::vector<int>& hidden) {
  std::vector<int> widths = {inputs};
  widths.insert(widths.end(), hidden.begin(), hidden.end());
  return widths;
}

std::vector<int> ExtrinsicsWidths(const PolicyStructure& s) {
  std::vector<int> widths = Widths(s.phys_size + s.shape_size(), s.extrinsics_widths);
  widths.push_back(s.z_size);
  return widths;
}

}  // namespace

// NOTE(paper): it gives widths only. Both encoders end linearly, with ELU between their layers.
Encoder::Encoder(ParamLayout& layout, const PolicyStructure& s)
    : phys_size_(s.phys_size),
      f_size_(s.f_size()),
      num_categories_(s.num_categories),
      cloud_(layout, "encoder/cloud", Widths(s.feature_size, s.cloud_widths), false),
      extrinsics_(layout, "encoder/extrinsics", ExtrinsicsWidths(s), false) {}

void Encoder::Initialize(Rng& rng, float* params) const {
  cloud_.Initialize(rng, 1, params);
  extrinsics_.Initialize(rng, 1, params);
}

template <typename T>
EncoderPass<T> Encoder::Carve(std::int64_t objects, std::int64_t n, Workspace<T>& work) const {
  EncoderPass<T> pass;
  pass.cloud = work.Take(cloud_.ActivationSize(objects));
  pass.shape = work.Take(objects * (f_size_ + num_categories_));
  pass.input = work.Take(n * extrinsics_.inputs());
  pass.extrinsics = work.Take(extrinsics_.ActivationSize(n));
  pass.dinput = work.Take(n * extrinsics_.inputs());
  pass.df = work.Take(objects * f_size_);
  pass.cloud_scratch = work.Take(cloud_.ScratchSize(objects));
  pass.extrinsics_scratch = work.Take(extrinsics_.ScratchSize(n));
  return pass;
}

template <typename T>
void Encoder::ShapeForward(const T* params, const ShapeInputs<T>& shapes,
                           EncoderPass<T>& pass) const {
  const T* f = cloud_.Forward(params, shapes.objects, shapes.feature, pass.cloud);
  T* shape = pass.shape;
  for (std::int64_t k = 0; k < shapes.objects; ++k) {
    shape = std::copy_n(f + k * f_size_, f_size_, shape);
    shape = std::copy_n(shapes.category + k * num_categories_, num_categories_, shape);
  }
}

template <typename T>
const T* Encoder::Forward(const T* params, const PolicyRows<T>& rows, EncoderPass<T>& pass) const {
  const int shape_size = f_size_ + num_categories_;
  T* input = pass.input;
  for (std::int64_t r = 0; r < rows.n; ++r) {
    input = std::copy_n(rows.phys + r * phys_size_, phys_size_, input);
    input = std::copy_n(pass.shape + std::int64_t{rows.object[r]} * shape_size, shape_size, input);
  }
  return extrinsics_.Forward(params, rows.n, pass.input, pass.extrinsics);
}

template <typename T>
void Encoder::Backward(const T* params, const ShapeInputs<T>& shapes, const PolicyRows<T>& rows,
                       EncoderPass<T>& pass, T* dz, T* grads) const {
  extrinsics_.Backward(params, rows.n, pass.input, pass.extrinsics, dz, pass.dinput, grads,
                       pass.extrinsics_scratch);
  // Forward gathered f by object; backward adds up, in row order.
  std::fill_n(pass.df, shapes.objects * f_size_, T(0));
  const int inputs = extrinsics_.inputs();
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const T* from = pass.dinput + r * inputs + phys_size_;
    T* to = pass.df + std::int64_t{rows.object[r]} * f_size_;
    for (int j = 0; j < f_size_; ++j) to[j] += from[j];
  }
  cloud_.Backward(params, shapes.objects, shapes.feature, pass.cloud, pass.df,
                  static_cast<T*>(nullptr), grads, pass.cloud_scratch);
}

#define DEX_INSTANTIATE(T)                                                                     \
  template EncoderPass<T> Encoder::Carve(std::int64_t, std::int64_t, Workspace<T>&) const;     \
  template void Encoder::ShapeForward(const T*, const ShapeInputs<T>&, EncoderPass<T>&) const; \
  template const T* Encoder::Forward(const T*, const PolicyRows<T>&, EncoderPass<T>&) const;   \
  template void Encoder::Backward(const T*, const ShapeInputs<T>&, const PolicyRows<T>&,       \
                                  EncoderPass<T>&, T*, T*) const;
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
