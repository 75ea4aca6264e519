#include "sim/lanes/object_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "sim/lanes/object_surface.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

constexpr int kN = kFieldNodes;
constexpr int kMaxCount = 32767;

// The stored origin and spacing are floats; nodes are where these say.
Vector3d NodePosition(const ObjectField& field, int x, int y, int z) {
  return field.origin.cast<double>() + field.spacing.cast<double>().cwiseProduct(Vector3d(x, y, z));
}

void PlaceGrid(const ConvexParts& parts, double margin, ObjectField& field) {
  Box3 box;
  for (const TriMesh& part : parts)
    for (const Vector3d& p : part.vertices) box.Extend(p);
  const Vector3d spacing = (box.Size().array() + 2 * margin) / (kN - 1);
  field.spacing = spacing.cast<float>();
  field.origin = (box.min.array() - margin).matrix().cast<float>();
}

// Marks the nodes inside any part, row by row along z: a convex body holds one interval of a row.
std::vector<std::uint8_t> InsideNodes(const ConvexParts& parts, const ObjectField& field) {
  std::vector<std::uint8_t> inside(kFieldSize, 0);
  const double step = field.spacing.z();
  for (const TriMesh& part : parts) {
    const ConvexBody body = BodyOf(part);
    for (int x = 0; x < kN; ++x)
      for (int y = 0; y < kN; ++y) {
        const Vector3d start = NodePosition(field, x, y, 0);
        if ((start.head<2>().array() < body.box.min.head<2>().array()).any() ||
            (start.head<2>().array() > body.box.max.head<2>().array()).any())
          continue;
        double low = 0, high = (kN - 1) * step;  // along the row; m
        for (const FacePlane& plane : body.planes) {
          const double height = plane.normal.dot(start) - plane.offset, slope = plane.normal.z();
          if (slope > 0) high = std::min(high, -height / slope);
          if (slope < 0) low = std::max(low, -height / slope);
          if (slope == 0 && height > 0) high = -1;
        }
        low = std::min(low, kN * step);  // nearly upright faces cross far away
        for (int z = static_cast<int>(std::ceil(low / step)); z < kN && z * step <= high; ++z)
          inside[FieldIndex(x, y, z)] = 1;
      }
  }
  return inside;
}

// Signed distance at every node, by FieldIndex. Nodes are visited to and fro, so that each follows
// a neighbour.
std::vector<double> NodeDistances(const ConvexParts& parts, const ObjectField& field) {
  const std::vector<std::uint8_t> inside = InsideNodes(parts, field);
  UnionDistance distance(parts);
  std::vector<double> distances(kFieldSize);
  for (int x = 0; x < kN; ++x)
    for (int j = 0; j < kN; ++j) {
      const int y = x & 1 ? kN - 1 - j : j;
      for (int k = 0; k < kN; ++k) {
        const int z = (x + j) & 1 ? kN - 1 - k : k;
        const int node = FieldIndex(x, y, z);
        distances[node] = distance.Signed(NodePosition(field, x, y, z), inside[node]);
      }
    }
  return distances;
}

// Between nodes of distance h the trilinear value of a function with second derivative k along an
// axis is off by k x (h - x) / 2, by k h^2 / 12 on average. Taking that average off the nodes
// outside halves the typical error around edges and corners, where distances are curved, and
// changes nothing over flat faces.
void TakeOffMeanError(std::vector<double>& distances) {
  const std::vector<double> exact = distances;
  for (int x = 1; x < kN - 1; ++x)
    for (int y = 1; y < kN - 1; ++y)
      for (int z = 1; z < kN - 1; ++z) {
        const int node = FieldIndex(x, y, z);
        if (exact[node] <= 0) continue;
        double second = 0;  // k h^2, summed over the axes
        for (const int next : {FieldIndex(1, 0, 0), FieldIndex(0, 1, 0), FieldIndex(0, 0, 1)})
          second += exact[node - next] - 2 * exact[node] + exact[node + next];
        distances[node] -= second / 12;
      }
}

void Quantise(const std::vector<double>& distances, ObjectField& field) {
  double largest = 0;
  for (const double d : distances) largest = std::max(largest, std::abs(d));
  field.quantum = static_cast<float>(largest / kMaxCount);
  for (const double d : distances) {
    const double counts = std::round(d / field.quantum);
    field.nodes.push_back(
        static_cast<std::int16_t>(std::clamp<double>(counts, -kMaxCount, kMaxCount)));
  }
}

}  // namespace

ObjectField BuildObjectField(const ConvexParts& parts, double margin) {
  DEX_CHECK(!parts.empty());
  DEX_CHECK_GT(margin, 0);
  ObjectField field;
  PlaceGrid(parts, margin, field);
  std::vector<double> distances = NodeDistances(parts, field);
  TakeOffMeanError(distances);
  Quantise(distances, field);
  return field;
}

FieldSample SampleField(const ObjectField& field, const Vector3d& p_O) {
  const Vector3d spacing = field.spacing.cast<double>(), origin = field.origin.cast<double>();
  const Vector3d nearest = p_O.cwiseMax(origin).cwiseMin(origin + (kN - 1) * spacing);
  std::array<int, 3> cell;
  Vector3d t;
  for (int k = 0; k < 3; ++k) {
    const double at = (nearest[k] - origin[k]) / spacing[k];
    cell[k] = std::clamp(static_cast<int>(at), 0, kN - 2);
    t[k] = at - cell[k];
  }
  double value = 0;
  Vector3d slope = Vector3d::Zero();
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner & 1, dy = corner >> 1;
    const int node = FieldIndex(cell[0] + dx, cell[1] + dy, cell[2]);
    const double low = field.nodes[node], high = field.nodes[node + 1];
    const double along_z = low + t.z() * (high - low);
    const double wx = dx ? t.x() : 1 - t.x(), wy = dy ? t.y() : 1 - t.y();
    value += wx * wy * along_z;
    slope += Vector3d((dx ? wy : -wy) * along_z, (dy ? wx : -wx) * along_z, wx * wy * (high - low));
  }
  FieldSample sample = {field.quantum * value, field.quantum * slope.cwiseQuotient(spacing)};
  const Vector3d beyond = p_O - nearest;
  if (beyond.squaredNorm() > 0) {
    // The value along a clamped axis comes from the distance alone.
    for (int k = 0; k < 3; ++k)
      if (beyond[k] != 0) sample.gradient[k] = 0;
    sample.distance += beyond.norm();
    sample.gradient += beyond.normalized();
  }
  return sample;
}

}  // namespace dexremoe
