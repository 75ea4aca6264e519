// PointNet++ with single-scale grouping (Qi et al. 2017, arXiv 1706.02413) as a classifier whose
// next-to-last layer is the shape descriptor p of the paper (section III-B).
//
//   cloud -> set abstraction 1 -> set abstraction 2 -> group all -> head widths -> p -> category
//
// A set abstraction runs a small network over every point of every neighbourhood and keeps the
// maximum over the neighbourhood. Forward stands beside backward; float for use, float or bfloat16
// for training, double for gradient checks.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/options.h"
#include "base/random.h"
#include "nn/mlp.h"
#include "shape/grouping.h"

namespace dexremoe {

// Width of p (paper, section III-B).
inline constexpr int kDescriptorSize = 100;

// Defaults are the original's sizes for 1024 points (SSG classification).
struct PointNetSizes {
  int points = 1024;  // at most so many enter
  GroupSizes level1 = {512, 0.2, 32};
  GroupSizes level2 = {128, 0.4, 64};
  std::vector<int> widths1 = {64, 64, 128};
  std::vector<int> widths2 = {128, 128, 256};
  std::vector<int> widths3 = {256, 512, 1024};  // over the group of all centroids
  // NOTE(paper): the paper takes a 100-wide feature from PointNet++, whose own classifier ends 512,
  // 256, categories. We keep 512 and 256 and put the 100-wide layer between them and the
  // categories, so that p is what the categories are read from.
  std::vector<int> head = {512, 256};
  int feature = kDescriptorSize;
  int categories = 6;
  // Options shape.points, shape.sa1_centroids, ... for all but feature and categories.
  void Register(Options& options);
  // Throws Error naming the size that cannot be.
  void Check() const;
};

// What a forward pass of some clouds keeps for the backward pass, and scratch. T is what weights
// and activations are stored in.
template <typename T>
struct PointNetWorkspace {
  struct Level {
    std::vector<T> input;        // [rows, 3 + c]: local coordinates and features of the points
    std::vector<T> activations;  // of the level's network
    std::vector<T> pooled;       // [groups, k]
    std::vector<std::int32_t> winner;  // [groups, k]: row of the maximum
  };
  struct Cloud {
    std::array<Level, 3> levels;
  };
  std::vector<Cloud> clouds;
  std::vector<T> global;                     // [B, last of widths3]
  std::vector<T> head, feature, classifier;  // activations of the three
  std::vector<Wide<T>> p, logits;            // [B, feature size], [B, categories]
  std::vector<T> dy, dx, dpooled, scratch;
  std::vector<Wide<T>> dfeatures;  // of a level's points, summed over the groups they are in
};

class PointNet {
 public:
  // Adds its blocks to `layout`.
  PointNet(ParamLayout& layout, const PointNetSizes& sizes);
  const PointNetSizes& sizes() const { return sizes_; }

  GroupedCloud Group(std::span<const Eigen::Vector3f> points) const;

  // Sets work.p and work.logits for the B clouds.
  template <typename T>
  void Forward(const T* params, std::span<const GroupedCloud> clouds,
               PointNetWorkspace<T>& work) const;
  // dlogits [B, categories]; adds to grads. The workspace holds the forward pass.
  template <typename T>
  void Backward(const T* params, std::span<const GroupedCloud> clouds, const Wide<T>* dlogits,
                PointNetWorkspace<T>& work, Wide<T>* grads) const;

  // Random weights, then normalised layer by layer on `clouds` (Mlp::NormalizeOnData), so that what
  // all clouds have in common does not drown what tells them apart.
  void Initialize(Rng& rng, std::span<const GroupedCloud> clouds, float* params) const;

 private:
  template <typename T>
  void ForwardCloud(const T* params, const GroupedCloud& cloud,
                    typename PointNetWorkspace<T>::Cloud& work) const;
  template <typename T>
  void BackwardCloud(const T* params, const GroupedCloud& cloud, const T* dglobal,
                     typename PointNetWorkspace<T>::Cloud& kept, PointNetWorkspace<T>& work,
                     Wide<T>* grads) const;
  void NormalizeStage(int stage, std::span<const GroupedCloud> clouds, float* params) const;

  PointNetSizes sizes_;
  std::array<Mlp, 3> level_;
  // NOTE(paper): ReLU as in the original up to p; p itself is ELU, so that none of its 100 numbers
  // can be dead. There is no batch normalisation, which would make a descriptor depend on the
  // others in its batch, and no dropout: normalising once on data before the first step, inputs of
  // one size and clipped gradients train stably.
  Mlp head_, feature_, classifier_;
};

}  // namespace dexremoe
