#include "policy/encoder.h"

#include <algorithm>

#include "nn/kernels.h"

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
      feature_size_(s.feature_size),
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
  pass.feature = work.Take(objects * feature_size_);
  pass.cloud = work.Take(cloud_.ActivationSize(objects));
  pass.shape = work.Take(objects * (f_size_ + num_categories_));
  pass.input = work.Take(n * extrinsics_.inputs());
  pass.extrinsics = work.Take(extrinsics_.ActivationSize(n));
  pass.dshape = work.Take(n * (f_size_ + num_categories_));
  pass.df = work.template Take<Wide<T>>(objects * f_size_);
  pass.df_stored = work.Take(objects * f_size_);
  pass.cloud_scratch = work.Take(cloud_.ScratchSize(objects));
  pass.extrinsics_scratch = work.Take(extrinsics_.ScratchSize(n));
  return pass;
}

template <typename T>
void Encoder::ShapeForward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                           EncoderPass<T>& pass) const {
  Cast(shapes.objects * feature_size_, shapes.feature, pass.feature);
  const T* f = cloud_.Forward(params, shapes.objects, pass.feature, pass.cloud);
  T* shape = pass.shape;
  for (std::int64_t k = 0; k < shapes.objects; ++k) {
    shape = std::copy_n(f + k * f_size_, f_size_, shape);
    Cast(num_categories_, shapes.category + k * num_categories_, shape);
    shape += num_categories_;
  }
}

template <typename T>
const T* Encoder::Forward(const T* params, const PolicyRows<Wide<T>>& rows,
                          EncoderPass<T>& pass) const {
  const int shape_size = f_size_ + num_categories_;
  T* input = pass.input;
  for (std::int64_t r = 0; r < rows.n; ++r) {
    Cast(phys_size_, rows.phys + r * phys_size_, input);
    input += phys_size_;
    input = std::copy_n(pass.shape + std::int64_t{rows.object[r]} * shape_size, shape_size, input);
  }
  return extrinsics_.Forward(params, rows.n, pass.input, pass.extrinsics);
}

template <typename T>
void Encoder::Backward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                       const PolicyRows<Wide<T>>& rows, EncoderPass<T>& pass, T* dz,
                       Wide<T>* grads) const {
  const int shape_size = f_size_ + num_categories_;
  extrinsics_.Backward(params, rows.n, pass.input, pass.extrinsics, dz, pass.dshape, grads,
                       pass.extrinsics_scratch, phys_size_);
  // Forward gathered f by object; backward adds up, in row order.
  std::fill_n(pass.df, shapes.objects * f_size_, Wide<T>(0));
  for (std::int64_t r = 0; r < rows.n; ++r)
    AddTo(f_size_, pass.dshape + r * shape_size, pass.df + std::int64_t{rows.object[r]} * f_size_);
  Cast(shapes.objects * f_size_, pass.df, pass.df_stored);
  cloud_.Backward(params, shapes.objects, pass.feature, pass.cloud, pass.df_stored,
                  static_cast<T*>(nullptr), grads, pass.cloud_scratch);
}

#define DEX_INSTANTIATE(T)                                                                         \
  template EncoderPass<T> Encoder::Carve(std::int64_t, std::int64_t, Workspace<T>&) const;         \
  template void Encoder::ShapeForward(const T*, const ShapeInputs<Wide<T>>&, EncoderPass<T>&)      \
      const;                                                                                       \
  template const T* Encoder::Forward(const T*, const PolicyRows<Wide<T>>&, EncoderPass<T>&) const; \
  template void Encoder::Backward(const T*, const ShapeInputs<Wide<T>>&,                           \
                                  const PolicyRows<Wide<T>>&, EncoderPass<T>&, T*, Wide<T>*)       \
      const;
DEX_INSTANTIATE(BFloat16)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
