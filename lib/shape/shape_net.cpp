#include "shape/shape_net.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numeric>

#include "nn/kernels.h"
#include "nn/layers.h"

namespace dexremoe {
namespace {

template <typename T>
ShapeDescriptor Describe(const PointNet& net, const T* params,
                         std::span<const Eigen::Vector3f> points, PointNetWorkspace<T>& work) {
  const GroupedCloud cloud = net.Group(points);
  net.Forward<T>(params, {&cloud, 1}, work);
  return {work.p, work.logits};
}

std::vector<Eigen::Vector3f> Rotated(std::span<const Eigen::Vector3f> points,
                                     const Eigen::Quaternionf& rotation) {
  const Eigen::Matrix3f R = rotation.toRotationMatrix();
  std::vector<Eigen::Vector3f> rotated;
  rotated.reserve(points.size());
  for (const Eigen::Vector3f& p : points) rotated.push_back(R * p);
  return rotated;
}

}  // namespace

std::vector<float> CategoryProbabilities(const ShapeDescriptor& descriptor) {
  std::vector<float> probabilities(descriptor.logits.size());
  SoftmaxForward<float>(1, static_cast<std::int64_t>(probabilities.size()),
                        descriptor.logits.data(), probabilities.data());
  return probabilities;
}

std::string LikelyCategories(const ShapeDescriptor& descriptor) {
  const std::vector<float> probability = CategoryProbabilities(descriptor);
  std::vector<std::size_t> order(probability.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return probability[a] > probability[b]; });
  std::string text;
  float sum = 0;
  for (std::size_t i = 0; i < order.size() && sum < 0.95f; ++i) {
    text += fmt::format("{}{} {:.3f}", i > 0 ? ", " : "", kShapeCategories[order[i]],
                        probability[order[i]]);
    sum += probability[order[i]];
  }
  return text;
}

ShapeDescriptor DescribeShape(const ShapeNet& net, std::span<const Eigen::Vector3f> points) {
  PointNetWorkspace<float> work;
  return Describe(net.net, net.params.data(), points, work);
}

template <typename T>
std::vector<ShapeDescriptor> DescribeRotated(const ShapeNet& net,
                                             std::span<const Eigen::Vector3f> points,
                                             std::span<const Eigen::Quaternionf> rotations,
                                             ThreadPool& pool) {
  std::vector<T> params(net.params.size());
  Cast(static_cast<std::int64_t>(params.size()), net.params.data(), params.data());
  std::vector<ShapeDescriptor> descriptors(rotations.size());
  std::vector<PointNetWorkspace<T>> workspaces(pool.workers());
  pool.ParallelFor(static_cast<int>(rotations.size()), [&](int i, int worker) {
    descriptors[i] =
        Describe(net.net, params.data(), Rotated(points, rotations[i]), workspaces[worker]);
  });
  return descriptors;
}

template std::vector<ShapeDescriptor> DescribeRotated<float>(const ShapeNet&,
                                                             std::span<const Eigen::Vector3f>,
                                                             std::span<const Eigen::Quaternionf>,
                                                             ThreadPool&);
template std::vector<ShapeDescriptor> DescribeRotated<BFloat16>(const ShapeNet&,
                                                                std::span<const Eigen::Vector3f>,
                                                                std::span<const Eigen::Quaternionf>,
                                                                ThreadPool&);

}  // namespace dexremoe
