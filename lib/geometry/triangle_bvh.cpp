#include "geometry/triangle_bvh.h"

#include <algorithm>
#include <numbers>
#include <numeric>

#include "base/check.h"

namespace dexremoe {
namespace {

constexpr int kLeafSize = 6;
// A cluster counts as far when the point is farther than this many radii: error about 0.01.
constexpr double kFar = 2.3;

double SquaredDistance(const Box3& box, const Eigen::Vector3d& p) {
  return (box.min - p).cwiseMax(p - box.max).cwiseMax(0.0).squaredNorm();
}

// Sum of the angles of complex numbers: the angle of their product and how often that went round.
// One arctangent in all in place of one each, which was half of the time of a winding number.
class AngleSum {
 public:
  void Add(double x, double y) {
    const double size = std::abs(x) + std::abs(y);
    if (size == 0) return;
    const double re = x_ * x - y_ * y, im = x_ * y + y_ * x;
    // Both angles have one sign and their sum leaves (-pi, pi].
    if (y_ >= 0 && y >= 0 && im < 0) ++turns_;
    if (y_ < 0 && y < 0 && im >= 0) --turns_;
    const double scale = 1 / (std::abs(re) + std::abs(im));
    x_ = scale * re, y_ = scale * im;
  }
  double Radians() const { return std::atan2(y_, x_) + 2 * std::numbers::pi * turns_; }

 private:
  double x_ = 1, y_ = 0;
  int turns_ = 0;
};

// Adds half of the solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983).
void AddHalfSolidAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       AngleSum& sum) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  sum.Add(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb, a.dot(b.cross(c)));
}

}  // namespace

Eigen::Vector3d ClosestPointOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return d1 > d3 ? Eigen::Vector3d(a + d1 / (d1 - d3) * ab) : a;
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return d2 > d6 ? Eigen::Vector3d(a + d2 / (d2 - d6) * ac) : a;
  const double va = d3 * d6 - d5 * d4;
  const double to_c = d4 - d3, to_b = d5 - d6;
  if (va <= 0 && to_c >= 0 && to_b >= 0 && to_c + to_b > 0)
    return b + to_c / (to_c + to_b) * (c - b);
  const double sum = va + vb + vc;
  return sum > 0 ? Eigen::Vector3d(a + vb / sum * ab + vc / sum * ac) : a;
}

TriangleBvh::TriangleBvh(const TriMesh& mesh) {
  DEX_CHECK(!mesh.triangles.empty());
  index_.resize(mesh.triangles.size());
  std::iota(index_.begin(), index_.end(), 0);
  for (const auto& [a, b, c] : mesh.triangles)
    corners_.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  Build(0, static_cast<int>(index_.size()));
  std::vector<Corners> ordered;
  for (const int t : index_) ordered.push_back(corners_[t]);
  corners_ = std::move(ordered);
  place_.resize(index_.size());
  for (std::size_t i = 0; i < index_.size(); ++i) place_[index_[i]] = static_cast<int>(i);
}

// While building, index_ is permuted and corners_ stays in mesh order.
int TriangleBvh::Build(int first, int last) {
  const int self = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Summarise(nodes_[self], first, last);
  if (last - first <= kLeafSize) {
    nodes_[self].first = first;
    nodes_[self].count = last - first;
    return self;
  }
  int axis = 0;
  nodes_[self].box.Size().maxCoeff(&axis);
  const int middle = (first + last) / 2;
  const auto key = [&](int t) {
    return corners_[t].a[axis] + corners_[t].b[axis] + corners_[t].c[axis];
  };
  std::nth_element(index_.begin() + first, index_.begin() + middle, index_.begin() + last,
                   [&](int s, int t) {
                     const double ks = key(s), kt = key(t);
                     return ks != kt ? ks < kt : s < t;
                   });
  Build(first, middle);
  const int right = Build(middle, last);
  nodes_[self].right = right;
  return self;
}

void TriangleBvh::Summarise(Node& node, int first, int last) const {
  double total = 0;
  for (int i = first; i < last; ++i) {
    const auto& [a, b, c] = corners_[index_[i]];
    for (const Eigen::Vector3d& v : {a, b, c}) node.box.Extend(v);
    const Eigen::Vector3d area = (b - a).cross(c - a) / 2;
    node.area += area;
    node.center += area.norm() * (a + b + c) / 3;
    total += area.norm();
  }
  node.center = total > 0 ? Eigen::Vector3d(node.center / total) : node.box.Center();
  for (int i = first; i < last; ++i)
    for (const Eigen::Vector3d& v :
         {corners_[index_[i]].a, corners_[index_[i]].b, corners_[index_[i]].c})
      node.radius = std::max(node.radius, (v - node.center).norm());
}

SurfacePoint TriangleBvh::Closest(const Eigen::Vector3d& p, int hint) const {
  SurfacePoint best;
  double best_squared = INFINITY;
  const auto visit = [&](int i) {
    const Eigen::Vector3d q =
        ClosestPointOnTriangle(p, corners_[i].a, corners_[i].b, corners_[i].c);
    const double squared = (q - p).squaredNorm();
    if (squared >= best_squared) return;
    best_squared = squared;
    best.point = q;
    best.triangle = index_[i];
  };
  if (hint >= 0) visit(place_[hint]);
  int stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (SquaredDistance(node.box, p) >= best_squared) continue;
    for (int i = node.first; i < node.first + node.count; ++i) visit(i);
    if (node.count > 0) continue;
    const int left = static_cast<int>(&node - nodes_.data()) + 1;
    const bool left_first =
        SquaredDistance(nodes_[left].box, p) <= SquaredDistance(nodes_[node.right].box, p);
    stack[depth++] = left_first ? node.right : left;
    stack[depth++] = left_first ? left : node.right;
  }
  best.distance = std::sqrt(best_squared);
  return best;
}

double TriangleBvh::WindingNumber(const Eigen::Vector3d& p) const {
  double far = 0;
  AngleSum near;  // half of it
  int stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    const Eigen::Vector3d to_center = node.center - p;
    const double squared = to_center.squaredNorm();
    if (squared > kFar * kFar * node.radius * node.radius) {
      far += node.area.dot(to_center) / (squared * std::sqrt(squared));
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i)
      AddHalfSolidAngle(corners_[i].a - p, corners_[i].b - p, corners_[i].c - p, near);
    if (node.count > 0) continue;
    stack[depth++] = node.right;
    stack[depth++] = static_cast<int>(&node - nodes_.data()) + 1;
  }
  return (far + 2 * near.Radians()) / (4 * std::numbers::pi);
}

std::vector<Eigen::Vector3d> SpreadOverSurface(const TriMesh& mesh, int count) {
  std::vector<double> up_to;  // summed areas
  double total = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    total +=
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
    up_to.push_back(total);
  }
  std::vector<Eigen::Vector3d> points;
  if (!(total > 0)) return points;
  constexpr double kPlastic = 1.32471795724474602596;
  double u = 0.5, v = 0.5;
  for (int i = 0; i < count; ++i) {
    const auto at = std::lower_bound(up_to.begin(), up_to.end(), (i + 0.5) / count * total);
    const auto& [a, b, c] =
        mesh.triangles[std::min<std::size_t>(at - up_to.begin(), up_to.size() - 1)];
    u = std::fmod(u + 1 / kPlastic, 1.0);
    v = std::fmod(v + 1 / (kPlastic * kPlastic), 1.0);
    const double root = std::sqrt(u);
    points.push_back((1 - root) * mesh.vertices[a] + root * (1 - v) * mesh.vertices[b] +
                     root * v * mesh.vertices[c]);
  }
  return points;
}

}  // namespace dexremoe
