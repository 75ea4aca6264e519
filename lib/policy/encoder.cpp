#include "policy/encoder.h"

#include <algorithm>

#include "nn/kernels.h"
#include "shape/max_pool.h"

namespace dexremoe {
namespace {

std::vector<int> Widths(int inputs, const std::vector<int>& hidden) {
  std::vector<int> widths = {inputs};
  widths.insert(widths.end(), hidden.begin(), hidden.end());
  return widths;
}

std::vector<int> ExtrinsicsWidths(const PolicyStructure& s) {
  std::vector<int> widths = Widths(s.phys_inputs() + s.shape_size(), s.extrinsics_widths);
  widths.push_back(s.z_size);
  return widths;
}

std::optional<Mlp> MakeCloud(ParamLayout& layout, const PolicyStructure& s) {
  if (!s.see_cloud) return std::nullopt;
  const int inputs = s.cloud_points > 0 ? 3 : s.feature_size;
  return Mlp(layout, "encoder/cloud", Widths(inputs, s.cloud_widths), false);
}

}  // namespace

// NOTE(paper): it gives widths only. Both encoders end linearly, with ELU between their layers.
Encoder::Encoder(ParamLayout& layout, const PolicyStructure& s)
    : phys_size_(s.phys_size),
      phys_inputs_(s.phys_inputs()),
      feature_size_(s.feature_size),
      cloud_points_(s.cloud_points),
      f_size_(s.f_size()),
      num_categories_(s.num_categories),
      shape_size_(s.shape_size()),
      phys_seen_(s.phys_seen),
      see_category_(s.see_category),
      cloud_(MakeCloud(layout, s)),
      extrinsics_(layout, "encoder/extrinsics", ExtrinsicsWidths(s), false) {}

void Encoder::Initialize(Rng& rng, float* params) const {
  if (cloud_) cloud_->Initialize(rng, 1, params);
  extrinsics_.Initialize(rng, 1, params);
}

template <typename T>
EncoderPass<T> Encoder::Carve(std::int64_t objects, std::int64_t n, Workspace<T>& work) const {
  const std::int64_t cloud_rows = CloudRows(objects);
  EncoderPass<T> pass;
  pass.feature = work.Take(objects * feature_size_);
  pass.cloud = work.Take(cloud_ ? cloud_->ActivationSize(cloud_rows) : 0);
  pass.pooled = work.Take(objects * f_size_);
  pass.winner = work.template Take<std::int32_t>(objects * f_size_);
  pass.shape = work.Take(objects * shape_size_);
  pass.input = work.Take(n * extrinsics_.inputs());
  pass.extrinsics = work.Take(extrinsics_.ActivationSize(n));
  pass.dshape = work.Take(n * shape_size_);
  pass.df = work.template Take<Wide<T>>(objects * f_size_);
  pass.df_stored = work.Take(objects * f_size_);
  pass.df_points = work.Take(cloud_points_ > 0 ? cloud_rows * f_size_ : 0);
  pass.cloud_scratch = work.Take(cloud_ ? cloud_->ScratchSize(cloud_rows) : 0);
  pass.extrinsics_scratch = work.Take(extrinsics_.ScratchSize(n));
  return pass;
}

template <typename T>
const T* Encoder::CloudForward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                               EncoderPass<T>& pass) const {
  const std::int64_t objects = shapes.objects;
  Cast(objects * feature_size_, shapes.feature, pass.feature);
  const T* mapped = cloud_->Forward(params, CloudRows(objects), pass.feature, pass.cloud);
  if (cloud_points_ == 0) return mapped;
  std::vector<int> begin;
  for (std::int64_t k = 0; k <= objects; ++k) begin.push_back(static_cast<int>(k * cloud_points_));
  MaxPoolForward(begin, f_size_, mapped, pass.pooled, pass.winner);
  return pass.pooled;
}

template <typename T>
void Encoder::ShapeForward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                           EncoderPass<T>& pass) const {
  const T* f = cloud_ ? CloudForward(params, shapes, pass) : nullptr;
  T* shape = pass.shape;
  for (std::int64_t k = 0; k < shapes.objects; ++k) {
    if (cloud_) shape = std::copy_n(f + k * f_size_, f_size_, shape);
    if (!see_category_) continue;
    Cast(num_categories_, shapes.category + k * num_categories_, shape);
    shape += num_categories_;
  }
}

template <typename T>
const T* Encoder::Forward(const T* params, const PolicyRows<Wide<T>>& rows,
                          EncoderPass<T>& pass) const {
  std::vector<Wide<T>> seen(phys_seen_.size());
  T* input = pass.input;
  for (std::int64_t r = 0; r < rows.n; ++r) {
    const Wide<T>* phys = rows.phys + r * phys_size_;
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = phys[phys_seen_[i]];
    Cast(phys_inputs_, seen.empty() ? phys : seen.data(), input);
    input += phys_inputs_;
    input =
        std::copy_n(pass.shape + std::int64_t{rows.object[r]} * shape_size_, shape_size_, input);
  }
  return extrinsics_.Forward(params, rows.n, pass.input, pass.extrinsics);
}

template <typename T>
void Encoder::Backward(const T* params, const ShapeInputs<Wide<T>>& shapes,
                       const PolicyRows<Wide<T>>& rows, EncoderPass<T>& pass, T* dz, Wide<T>* grads,
                       const Wide<T>* dshape) const {
  extrinsics_.Backward(params, rows.n, pass.input, pass.extrinsics, dz,
                       cloud_ ? pass.dshape : static_cast<T*>(nullptr), grads,
                       pass.extrinsics_scratch, phys_inputs_);
  if (cloud_) CloudBackward(params, shapes.objects, rows, pass, grads, dshape);
}

// Forward gathered f by object; backward adds up, in row order.
template <typename T>
void Encoder::CloudBackward(const T* params, std::int64_t objects, const PolicyRows<Wide<T>>& rows,
                            EncoderPass<T>& pass, Wide<T>* grads, const Wide<T>* dshape) const {
  std::fill_n(pass.df, objects * f_size_, Wide<T>(0));
  for (std::int64_t r = 0; r < rows.n; ++r)
    AddTo(f_size_, pass.dshape + r * shape_size_, pass.df + std::int64_t{rows.object[r]} * f_size_);
  for (std::int64_t k = 0; dshape != nullptr && k < objects; ++k)
    AddTo(f_size_, dshape + k * shape_size_, pass.df + k * f_size_);
  Cast(objects * f_size_, pass.df, pass.df_stored);
  T* df = pass.df_stored;
  const std::int64_t rows_of_cloud = CloudRows(objects);
  if (cloud_points_ > 0) {
    df = pass.df_points;
    MaxPoolBackward(static_cast<int>(objects), static_cast<int>(rows_of_cloud), f_size_,
                    pass.df_stored, pass.winner, df);
  }
  cloud_->Backward(params, rows_of_cloud, pass.feature, pass.cloud, df, static_cast<T*>(nullptr),
                   grads, pass.cloud_scratch);
}

#define DEX_INSTANTIATE(T)                                                                         \
  template EncoderPass<T> Encoder::Carve(std::int64_t, std::int64_t, Workspace<T>&) const;         \
  template void Encoder::ShapeForward(const T*, const ShapeInputs<Wide<T>>&, EncoderPass<T>&)      \
      const;                                                                                       \
  template const T* Encoder::Forward(const T*, const PolicyRows<Wide<T>>&, EncoderPass<T>&) const; \
  template void Encoder::Backward(const T*, const ShapeInputs<Wide<T>>&,                           \
                                  const PolicyRows<Wide<T>>&, EncoderPass<T>&, T*, Wide<T>*,       \
                                  const Wide<T>*) const;
DEX_INSTANTIATE(BFloat16)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
