#include "shape/shape_net.h"

#include <algorithm>

#include "nn/layers.h"

namespace dexremoe {
namespace {

ShapeDescriptor Describe(const ShapeNet& net, std::span<const Eigen::Vector3f> points,
                         PointNetWorkspace<float>& work) {
  const GroupedCloud cloud = net.net.Group(points);
  net.net.Forward<float>(net.params.data(), {&cloud, 1}, work);
  const PointNetSizes& sizes = net.net.sizes();
  return {{work.p, work.p + sizes.feature}, {work.logits, work.logits + sizes.categories}};
}

}  // namespace

std::vector<float> CategoryProbabilities(const ShapeDescriptor& descriptor) {
  std::vector<float> probabilities(descriptor.logits.size());
  SoftmaxForward<float>(1, static_cast<std::int64_t>(probabilities.size()),
                        descriptor.logits.data(), probabilities.data());
  return probabilities;
}

ShapeDescriptor DescribeShape(const ShapeNet& net, std::span<const Eigen::Vector3f> points) {
  PointNetWorkspace<float> work;
  return Describe(net, points, work);
}

std::vector<ShapeDescriptor> DescribeRotated(const ShapeNet& net,
                                             std::span<const Eigen::Vector3f> points,
                                             std::span<const Eigen::Quaternionf> rotations,
                                             ThreadPool& pool) {
  std::vector<ShapeDescriptor> descriptors(rotations.size());
  std::vector<PointNetWorkspace<float>> workspaces(pool.workers());
  pool.ParallelFor(static_cast<int>(rotations.size()), [&](int i, int worker) {
    std::vector<Eigen::Vector3f> rotated;
    rotated.reserve(points.size());
    const Eigen::Matrix3f R = rotations[i].toRotationMatrix();
    for (const Eigen::Vector3f& p : points) rotated.push_back(R * p);
    descriptors[i] = Describe(net, rotated, workspaces[worker]);
  });
  return descriptors;
}

}  // namespace dexremoe
