#include "shape/pointnet2.h"

#include <algorithm>

#include "base/check.h"
#include "base/error.h"
#include "nn/kernels.h"
#include "shape/max_pool.h"

namespace dexremoe {
namespace {

const PointNetSizes& Checked(const PointNetSizes& sizes) {
  sizes.Check();
  return sizes;
}

std::vector<int> Joined(int first, const std::vector<int>& rest) {
  std::vector<int> widths = {first};
  widths.insert(widths.end(), rest.begin(), rest.end());
  return widths;
}

// Input rows of a level: coordinates [rows,3] beside features [n,c] of the points they belong to.
template <typename T>
void JoinColumns(const std::vector<float>& coordinates, const std::vector<int>& index, int c,
                 const std::vector<T>& features, std::vector<T>& input) {
  const std::size_t rows = coordinates.size() / 3;
  input.resize(rows * (3 + c));
  T* to = input.data();
  for (std::size_t row = 0; row < rows; ++row) {
    Cast(3, coordinates.data() + 3 * row, to);
    const std::size_t point = index.empty() ? row : index[row];
    to = std::copy_n(features.data() + point * c, c, to + 3);
  }
}

// Runs a level's network over its rows and keeps the maximum of each group.
template <typename T>
void RunLevel(const Mlp& mlp, const T* params, const std::vector<int>& begin,
              typename PointNetWorkspace<T>::Level& level) {
  const std::int64_t rows = begin.back(), groups = static_cast<std::int64_t>(begin.size()) - 1;
  level.activations.resize(mlp.ActivationSize(rows));
  const T* y = mlp.Forward(params, rows, level.input.data(), level.activations.data());
  level.pooled.resize(groups * mlp.outputs());
  level.winner.resize(groups * mlp.outputs());
  MaxPoolForward(begin, mlp.outputs(), y, level.pooled.data(), level.winner.data());
}

// Back through a level: from work.dpooled to the input's gradient in work.dx (unless it is the
// cloud's own coordinates).
template <typename T>
void RunLevelBackward(const Mlp& mlp, const T* params, const T* dpooled, bool want_dx,
                      const typename PointNetWorkspace<T>::Level& level, PointNetWorkspace<T>& work,
                      Wide<T>* grads) {
  const std::int64_t rows = static_cast<std::int64_t>(level.input.size()) / mlp.inputs();
  const int k = mlp.outputs();
  work.dy.resize(rows * k);
  work.dx.resize(want_dx ? rows * mlp.inputs() : 0);
  work.scratch.resize(mlp.ScratchSize(rows));
  MaxPoolBackward(static_cast<int>(level.pooled.size()) / k, static_cast<int>(rows), k, dpooled,
                  level.winner.data(), work.dy.data());
  mlp.Backward(params, rows, level.input.data(), level.activations.data(), work.dy.data(),
               want_dx ? work.dx.data() : nullptr, grads, work.scratch.data());
}

// Adds up the feature columns of work.dx [rows, 3+c] point by point: work.dpooled [points, c].
template <typename T>
void ScatterFeatures(const std::vector<int>& index, int points, int c, PointNetWorkspace<T>& work) {
  const std::int64_t size = std::int64_t{points} * c;
  work.dfeatures.assign(size, Wide<T>(0));
  work.dpooled.resize(size);
  const std::size_t rows = work.dx.size() / (3 + c);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t point = index.empty() ? row : index[row];
    AddTo(c, work.dx.data() + row * (3 + c) + 3, work.dfeatures.data() + point * c);
  }
  Cast(size, work.dfeatures.data(), work.dpooled.data());
}

}  // namespace

PointNet::PointNet(ParamLayout& layout, const PointNetSizes& sizes)
    : sizes_(Checked(sizes)),
      level_{Mlp(layout, "sa1", Joined(3, sizes.widths1), true, Activation::kRelu),
             Mlp(layout, "sa2", Joined(3 + sizes.widths1.back(), sizes.widths2), true,
                 Activation::kRelu),
             Mlp(layout, "sa3", Joined(3 + sizes.widths2.back(), sizes.widths3), true,
                 Activation::kRelu)},
      head_(layout, "head", Joined(sizes.widths3.back(), sizes.head), true, Activation::kRelu),
      feature_(layout, "feature", {sizes.head.back(), sizes.feature}, true, Activation::kElu),
      classifier_(layout, "classifier", {sizes.feature, sizes.categories}, false) {}

GroupedCloud PointNet::Group(std::span<const Eigen::Vector3f> points) const {
  return GroupCloud(points, sizes_.points, sizes_.level1, sizes_.level2);
}

template <typename T>
void PointNet::ForwardCloud(const T* params, const GroupedCloud& cloud,
                            typename PointNetWorkspace<T>::Cloud& work) const {
  auto& [level1, level2, level3] = work.levels;
  level1.input.resize(cloud.level1.local.size());
  Cast(static_cast<std::int64_t>(level1.input.size()), cloud.level1.local.data(),
       level1.input.data());
  RunLevel<T>(level_[0], params, cloud.level1.begin, level1);
  JoinColumns(cloud.level2.local, cloud.level2.index, level_[0].outputs(), level1.pooled,
              level2.input);
  RunLevel<T>(level_[1], params, cloud.level2.begin, level2);
  JoinColumns(cloud.centers, {}, level_[1].outputs(), level2.pooled, level3.input);
  RunLevel<T>(level_[2], params, {0, cloud.level2.count()}, level3);
}

template <typename T>
void PointNet::Forward(const T* params, std::span<const GroupedCloud> clouds,
                       PointNetWorkspace<T>& work) const {
  const auto n = static_cast<std::int64_t>(clouds.size());
  work.clouds.resize(std::max(work.clouds.size(), clouds.size()));
  work.global.clear();
  for (std::int64_t i = 0; i < n; ++i) {
    ForwardCloud<T>(params, clouds[i], work.clouds[i]);
    const std::vector<T>& pooled = work.clouds[i].levels[2].pooled;
    work.global.insert(work.global.end(), pooled.begin(), pooled.end());
  }
  work.head.resize(head_.ActivationSize(n));
  work.feature.resize(feature_.ActivationSize(n));
  work.classifier.resize(classifier_.ActivationSize(n));
  const T* head = head_.Forward(params, n, work.global.data(), work.head.data());
  const T* p = feature_.Forward(params, n, head, work.feature.data());
  const T* logits = classifier_.Forward(params, n, p, work.classifier.data());
  work.p.resize(n * feature_.outputs());
  work.logits.resize(n * classifier_.outputs());
  Cast(n * feature_.outputs(), p, work.p.data());
  Cast(n * classifier_.outputs(), logits, work.logits.data());
}

template <typename T>
void PointNet::BackwardCloud(const T* params, const GroupedCloud& cloud, const T* dglobal,
                             typename PointNetWorkspace<T>::Cloud& kept, PointNetWorkspace<T>& work,
                             Wide<T>* grads) const {
  const auto& [level1, level2, level3] = kept.levels;
  RunLevelBackward<T>(level_[2], params, dglobal, true, level3, work, grads);
  ScatterFeatures(std::vector<int>(), cloud.level2.count(), level_[1].outputs(), work);
  RunLevelBackward<T>(level_[1], params, work.dpooled.data(), true, level2, work, grads);
  ScatterFeatures(cloud.level2.index, cloud.level1.count(), level_[0].outputs(), work);
  RunLevelBackward<T>(level_[0], params, work.dpooled.data(), false, level1, work, grads);
}

template <typename T>
void PointNet::Backward(const T* params, std::span<const GroupedCloud> clouds,
                        const Wide<T>* dlogits, PointNetWorkspace<T>& work, Wide<T>* grads) const {
  const auto n = static_cast<std::int64_t>(clouds.size());
  DEX_CHECK_EQ(static_cast<std::int64_t>(work.global.size()), n * level_[2].outputs());
  const T* head = work.head.data() + work.head.size() - n * head_.outputs();
  std::vector<T> dy(n * classifier_.outputs()), dp(n * feature_.outputs()),
      dhead(n * head_.outputs());
  std::vector<T> dglobal(n * head_.inputs());
  work.scratch.resize(head_.ScratchSize(n));
  Cast(n * classifier_.outputs(), dlogits, dy.data());
  classifier_.Backward(params, n, work.feature.data(), work.classifier.data(), dy.data(), dp.data(),
                       grads, work.scratch.data());
  feature_.Backward(params, n, head, work.feature.data(), dp.data(), dhead.data(), grads,
                    work.scratch.data());
  head_.Backward(params, n, work.global.data(), work.head.data(), dhead.data(), dglobal.data(),
                 grads, work.scratch.data());
  for (std::int64_t i = 0; i < n; ++i)
    BackwardCloud<T>(params, clouds[i], dglobal.data() + i * head_.inputs(), work.clouds[i], work,
                     grads);
}

void PointNet::Initialize(Rng& rng, std::span<const GroupedCloud> clouds, float* params) const {
  for (const Mlp& mlp : level_) mlp.InitializeHe(rng, params);
  head_.InitializeHe(rng, params);
  feature_.InitializeHe(rng, params);
  classifier_.Initialize(rng, 1.0, params);
  for (int stage = 0; stage < 5; ++stage) NormalizeStage(stage, clouds, params);
}

// Stages 0 to 2 are the levels, 3 the head, 4 the layer of p. The clouds run through the stages
// below, which are normalised already; of a level's rows every cloud gives about kRowsPerCloud.
void PointNet::NormalizeStage(int stage, std::span<const GroupedCloud> clouds,
                              float* params) const {
  constexpr std::size_t kRowsPerCloud = 128;
  const Mlp& mlp = stage < 3 ? level_[stage] : stage == 3 ? head_ : feature_;
  const std::size_t width = mlp.inputs();
  std::vector<float> rows;
  PointNetWorkspace<float> work;
  for (const GroupedCloud& cloud : clouds) {
    Forward<float>(params, {&cloud, 1}, work);
    const std::vector<float>& input = stage < 3    ? work.clouds[0].levels[stage].input
                                      : stage == 3 ? work.global
                                                   : work.head;
    const std::size_t first = stage < 4 ? 0 : input.size() - width;
    const std::size_t count = (input.size() - first) / width;
    const std::size_t stride = std::max<std::size_t>(count / kRowsPerCloud, 1);
    for (std::size_t row = 0; row < count; row += stride) {
      const auto from = input.begin() + first + row * width;
      rows.insert(rows.end(), from, from + width);
    }
  }
  mlp.NormalizeOnData(static_cast<std::int64_t>(rows.size() / width), rows.data(), params);
}

#define DEX_INSTANTIATE(T)                                                                        \
  template void PointNet::Forward(const T*, std::span<const GroupedCloud>, PointNetWorkspace<T>&) \
      const;                                                                                      \
  template void PointNet::Backward(const T*, std::span<const GroupedCloud>, const Wide<T>*,       \
                                   PointNetWorkspace<T>&, Wide<T>*) const;
DEX_INSTANTIATE(BFloat16)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(double)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
