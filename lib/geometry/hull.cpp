#include "geometry/hull.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/check.h"
#include "geometry/growing_hull.h"

extern "C" {
#include <libqhull_r/libqhull_r.h>
}

namespace dexremoe {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Owns one qhull state. Its messages go nowhere: failure is a status here.
class Qhull {
 public:
  Qhull(const Points& points, const char* command) : silence_(std::fopen("/dev/null", "w")) {
    for (const Eigen::Vector3d& p : points) flat_.insert(flat_.end(), p.begin(), p.end());
    qh_zero(&state_, silence_);
    std::string text = command;
    status_ = qh_new_qhull(&state_, 3, static_cast<int>(points.size()), flat_.data(), False,
                           text.data(), nullptr, silence_);
  }
  ~Qhull() {
    qh_freeqhull(&state_, qh_ALL);
    int long_blocks = 0, long_bytes = 0;
    qh_memfreeshort(&state_, &long_blocks, &long_bytes);
    if (silence_ != nullptr) std::fclose(silence_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  // Triangles as indices into the input points; empty after a failure.
  std::vector<std::array<int, 3>> Triangles() {
    std::vector<std::array<int, 3>> triangles;
    if (status_ != 0) return triangles;
    qhT* qh = &state_;
    facetT* facet;
    FORALLfacets {
      std::array<int, 3> t{};
      int corner = 0;
      vertexT *vertex, **vertexp;
      FOREACHvertex_(facet->vertices) {
        if (corner < 3) t[corner] = qh_pointid(qh, vertex->point);
        ++corner;
      }
      if (corner != 3) return {};
      if (facet->toporient ^ qh_ORIENTclock) std::swap(t[1], t[2]);
      triangles.push_back(t);
    }
    return triangles;
  }

 private:
  qhT state_;
  std::FILE* silence_;
  std::vector<coordT> flat_;
  int status_;
};

// Every half-edge has exactly one opposite, and Euler's formula holds as for a sphere.
bool IsClosedSphere(const TriMesh& mesh) {
  if (mesh.triangles.size() != 2 * mesh.vertices.size() - 4) return false;
  std::vector<std::pair<int, int>> forward, backward;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      forward.emplace_back(t[k], t[(k + 1) % 3]);
      backward.emplace_back(t[(k + 1) % 3], t[k]);
    }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  return forward == backward && std::adjacent_find(forward.begin(), forward.end()) == forward.end();
}

std::optional<TriMesh> FullHull(const Points& points) {
  // Qt triangulates facets that are not simplices; in rare cases that leaves overlapping slivers,
  // and then the input is joggled.
  for (const char* command : {"qhull Qt Pp", "qhull QJ Pp"}) {
    TriMesh hull = Compacted(points, Qhull(points, command).Triangles());
    if (hull.triangles.size() >= 4 && IsClosedSphere(hull) && MassPropertiesOf(hull).volume > 0)
      return hull;
  }
  return std::nullopt;
}

std::optional<TriMesh> LimitedHull(const TriMesh& full, int max_vertices) {
  GrowingHull hull(full.vertices);
  hull.Grow(max_vertices);
  return hull.solid() ? FullHull(hull.Mesh().vertices) : std::nullopt;
}

// Flat input with a thickness: the points moved both ways along the direction they lack.
Points Thickened(const Points& points, const std::vector<int>& simplex, double thickness) {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  if (simplex.size() == 3)
    normal = (points[simplex[1]] - points[simplex[0]])
                 .cross(points[simplex[2]] - points[simplex[0]])
                 .normalized();
  Points result;
  for (const Eigen::Vector3d& p : points)
    for (const double side : {-0.5, 0.5}) result.push_back(p + side * thickness * normal);
  return result;
}

}  // namespace

std::optional<TriMesh> ConvexHull(const Points& points, const HullOptions& options) {
  DEX_CHECK(options.max_vertices == 0 || options.max_vertices >= 4);
  if (points.size() < 3) return std::nullopt;
  const std::vector<int> simplex = SpanningSimplex(points);
  if (simplex.size() < 4) {
    if (!(options.thicken > 0) || simplex.size() < 3) return std::nullopt;
    return ConvexHull(Thickened(points, simplex, options.thicken), {options.max_vertices, 0});
  }
  std::optional<TriMesh> hull = FullHull(points);
  if (!hull || options.max_vertices == 0 ||
      static_cast<int>(hull->vertices.size()) <= options.max_vertices)
    return hull;
  return LimitedHull(*hull, options.max_vertices);
}

std::vector<int> SpanningSimplex(const Points& points) {
  const auto farthest = [&](const auto& distance) {
    int best = 0;
    double most = -INFINITY;
    for (int i = 0; i < static_cast<int>(points.size()); ++i)
      if (const double d = distance(points[i]); d > most) {
        most = d;
        best = i;
      }
    return best;
  };
  std::vector<int> chosen = {farthest([](const auto& p) { return p.x(); })};
  const Eigen::Vector3d a = points[chosen[0]];
  chosen.push_back(farthest([&](const auto& p) { return (p - a).squaredNorm(); }));
  const Eigen::Vector3d ab = points[chosen[1]] - a;
  const double flat = kFlatRatio * ab.norm();
  if (!(flat > 0)) return {chosen[0]};
  chosen.push_back(farthest([&](const auto& p) { return ab.cross(p - a).squaredNorm(); }));
  const Eigen::Vector3d normal = ab.cross(points[chosen[2]] - a);
  if (normal.norm() / ab.norm() <= flat) return {chosen[0], chosen[1]};
  chosen.push_back(farthest([&](const auto& p) { return std::abs(normal.dot(p - a)); }));
  if (std::abs(normal.dot(points[chosen[3]] - a)) / normal.norm() <= flat) chosen.pop_back();
  return chosen;
}

TriMesh Compacted(const Points& points, const std::vector<std::array<int, 3>>& triangles) {
  TriMesh mesh;
  std::vector<int> renumbered(points.size(), -1);
  for (std::array<int, 3> triangle : triangles) {
    for (int& index : triangle) {
      int& to = renumbered[index];
      if (to < 0) {
        to = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(points[index]);
      }
      index = to;
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

double HullVolume(const Points& points) {
  GrowingHull hull(points);
  hull.Grow();
  return hull.Volume();
}

double DistanceOutside(const TriMesh& hull, const Eigen::Vector3d& point) {
  double distance = -INFINITY;
  for (const auto& [a, b, c] : hull.triangles) {
    const Eigen::Vector3d& origin = hull.vertices[a];
    const Eigen::Vector3d normal = (hull.vertices[b] - origin).cross(hull.vertices[c] - origin);
    const double area = normal.norm();
    if (area > 0) distance = std::max(distance, normal.dot(point - origin) / area);
  }
  return distance;
}

double SharedVolume(const TriMesh& a, const TriMesh& b) {
  const Box3 box_a = BoundsOf(a), box_b = BoundsOf(b);
  const Box3 common = {box_a.min.cwiseMax(box_b.min), box_a.max.cwiseMin(box_b.max)};
  if (!((common.max - common.min).minCoeff() > 0)) return 0;
  constexpr int kSamples = 200;
  constexpr double kRatio = 1.22074408460575947536;  // root of x^4 = x + 1: the R3 sequence
  const Eigen::Vector3d step(1 / kRatio, 1 / (kRatio * kRatio), 1 / (kRatio * kRatio * kRatio));
  Eigen::Vector3d u = Eigen::Vector3d::Constant(0.5);
  int shared = 0;
  for (int i = 0; i < kSamples; ++i) {
    u += step;
    u -= u.array().floor().matrix();
    const Eigen::Vector3d p = common.min + common.Size().cwiseProduct(u);
    shared += DistanceOutside(a, p) <= 0 && DistanceOutside(b, p) <= 0;
  }
  return common.Size().prod() * shared / kSamples;
}

}  // namespace dexremoe
