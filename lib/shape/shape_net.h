// The trained PointNet++ and what it says about a cloud.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "base/thread_pool.h"
#include "shape/pointnet2.h"

namespace dexremoe {

// The paper's categories in the order of the logits.
inline constexpr std::array<const char*, 6> kShapeCategories = {"airplane", "animal", "head",
                                                                "shoe",     "train",  "vehicle"};

struct ShapeNet {
  // Parameters are zero until set, read or initialised.
  explicit ShapeNet(const PointNetSizes& sizes)
      : net(layout, sizes), params(static_cast<std::size_t>(layout.size()), 0.0f) {}

  ParamLayout layout;
  PointNet net;
  std::vector<float> params;  // as in `layout`
};

struct ShapeDescriptor {
  std::vector<float> feature;  // p [kDescriptorSize]
  std::vector<float> logits;   // [6], order of kShapeCategories
};

// Softmax of the logits: how likely each category is, as far as the shape tells.
std::vector<float> CategoryProbabilities(const ShapeDescriptor& descriptor);
// The most likely categories, falling, until they add up to 95 %: "train 0.870, vehicle 0.112".
std::string LikelyCategories(const ShapeDescriptor& descriptor);

// The descriptor of a cloud in any unit of length; the order of the points does not matter (beyond
// ties of farthest-point distances). Throws Error for a cloud that PointNet++ cannot group.
ShapeDescriptor DescribeShape(const ShapeNet& net, std::span<const Eigen::Vector3f> points);

// Descriptors of the cloud in many orientations, in parallel. T is float, or BFloat16 to see what
// the lower precision costs.
template <typename T = float>
std::vector<ShapeDescriptor> DescribeRotated(const ShapeNet& net,
                                             std::span<const Eigen::Vector3f> points,
                                             std::span<const Eigen::Quaternionf> rotations,
                                             ThreadPool& pool);

}  // namespace dexremoe
