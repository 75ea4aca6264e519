#include "shape/grouping.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "shape/farthest.h"

namespace dexremoe {
namespace {

std::vector<float> Flat(const std::vector<Eigen::Vector3f>& points) {
  std::vector<float> xyz;
  xyz.reserve(3 * points.size());
  for (const Eigen::Vector3f& p : points) xyz.insert(xyz.end(), p.data(), p.data() + 3);
  return xyz;
}

std::vector<float> Gather(std::span<const float> xyz, const std::vector<int>& order) {
  std::vector<float> result;
  result.reserve(3 * order.size());
  for (const int i : order)
    result.insert(result.end(), xyz.begin() + 3 * i, xyz.begin() + 3 * i + 3);
  return result;
}

}  // namespace

std::vector<Eigen::Vector3f> ToUnitSphere(std::span<const Eigen::Vector3f> points) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) center += p.cast<double>();
  center /= static_cast<double>(points.size());
  double largest = 0;
  for (const Eigen::Vector3f& p : points)
    largest = std::max(largest, (p.cast<double>() - center).norm());
  if (!center.allFinite() || !(largest > 0) || !std::isfinite(largest))
    Fail("cloud: expected finite points that are not all equal, found radius {}", largest);
  std::vector<Eigen::Vector3f> result;
  result.reserve(points.size());
  for (const Eigen::Vector3f& p : points)
    result.push_back(((p.cast<double>() - center) / largest).cast<float>());
  return result;
}

Groups BallQuery(std::span<const float> xyz, const GroupSizes& sizes) {
  const int n = static_cast<int>(xyz.size() / 3);
  const int centroids = std::min(sizes.centroids, n);
  const float radius = static_cast<float>(sizes.radius);
  const float radius2 = radius * radius, scale = 1 / radius;
  Groups groups;
  groups.begin.reserve(centroids + 1);
  groups.begin.push_back(0);
  for (int g = 0; g < centroids; ++g) {
    const float cx = xyz[3 * g], cy = xyz[3 * g + 1], cz = xyz[3 * g + 2];
    const int full = groups.begin.back() + sizes.neighbors;
    for (int i = 0; i < n && groups.rows() < full; ++i) {
      const float dx = xyz[3 * i] - cx, dy = xyz[3 * i + 1] - cy, dz = xyz[3 * i + 2] - cz;
      if (dx * dx + dy * dy + dz * dz > radius2) continue;
      groups.index.push_back(i);
      groups.local.insert(groups.local.end(), {dx * scale, dy * scale, dz * scale});
    }
    groups.begin.push_back(groups.rows());
  }
  return groups;
}

GroupedCloud GroupCloud(std::span<const Eigen::Vector3f> points, int max_points,
                        const GroupSizes& sizes1, const GroupSizes& sizes2) {
  if (points.size() < 4) Fail("cloud: expected at least 4 points, found {}", points.size());
  const std::vector<float> unit = Flat(ToUnitSphere(points));
  const int count = std::min(max_points, static_cast<int>(points.size()));
  const std::vector<float> xyz = Gather(unit, FarthestPointOrder(unit, count));
  GroupedCloud cloud;
  cloud.level1 = BallQuery(xyz, sizes1);
  const std::span<const float> centroids(xyz.data(), 3 * cloud.level1.count());
  cloud.level2 = BallQuery(centroids, sizes2);
  cloud.centers.assign(xyz.begin(), xyz.begin() + 3 * cloud.level2.count());
  return cloud;
}

}  // namespace dexremoe
