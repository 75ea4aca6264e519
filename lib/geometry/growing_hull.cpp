#include "geometry/growing_hull.h"

#include <algorithm>

#include "geometry/hull.h"

namespace dexremoe {
namespace {

// Points closer to a face than this share of the size count as on it.
constexpr double kOnFace = 1e-9;

}  // namespace

GrowingHull::GrowingHull(const std::vector<Eigen::Vector3d>& points) : points_(points) {
  if (points.size() < 4) return;
  std::vector<int> simplex = SpanningSimplex(points);
  if (simplex.size() < 4) return;
  for (const int i : simplex) {
    inside_ += points[i] / 4;
    tolerance_ = std::max(tolerance_, kOnFace * (points[i] - points[simplex[0]]).norm());
  }
  const Eigen::Vector3d a = points[simplex[0]], b = points[simplex[1]], c = points[simplex[2]];
  if ((b - a).cross(c - a).dot(points[simplex[3]] - a) > 0) std::swap(simplex[1], simplex[2]);
  // Corners of the faces and, edge by edge, the faces beyond.
  constexpr std::array<std::array<int, 3>, 4> kCorners = {
      {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
  constexpr std::array<std::array<int, 3>, 4> kBeyond = {
      {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}}};
  faces_.resize(4);
  for (int f = 0; f < 4; ++f) {
    const auto& [i, j, k] = kCorners[f];
    if (!MakeFace(simplex[i], simplex[j], simplex[k], faces_[f])) {
      faces_.clear();
      return;
    }
    faces_[f].beyond = kBeyond[f];
  }
  alive_ = 4;
  next_.assign(points.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i) Assign(static_cast<int>(i), 0);
}

bool GrowingHull::MakeFace(int a, int b, int c, Face& face) const {
  face.vertex = {a, b, c};
  face.normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]);
  const double length = face.normal.norm();
  if (!(length > tolerance_ * tolerance_)) return false;
  face.normal /= length;
  face.offset = face.normal.dot(points_[a]);
  return face.normal.dot(inside_) < face.offset;
}

void GrowingHull::Put(int point, double distance, Face& face) {
  next_[point] = face.first_outside;
  face.first_outside = point;
  if (distance <= face.distance) return;
  face.distance = distance;
  face.farthest = point;
}

void GrowingHull::Assign(int point, std::size_t first) {
  std::size_t best = faces_.size();
  double distance = tolerance_;
  for (std::size_t f = first; f < faces_.size(); ++f) {
    const double above = Above(faces_[f], point);
    if (above <= distance) continue;
    distance = above;
    best = f;
  }
  if (best < faces_.size()) Put(point, distance, faces_[best]);
}

bool GrowingHull::FindHorizon(int start, int point) {
  ++visits_;
  seen_ = {start};
  horizon_.clear();
  stack_ = {{start, 0, 0}};
  faces_[start].visit = visits_;
  while (!stack_.empty()) {
    Step& step = stack_.back();
    if (step.done == 3) {
      stack_.pop_back();
      continue;
    }
    const int edge = (step.entry + step.done++) % 3;
    const Face& face = faces_[step.face];
    const int to = face.vertex[(edge + 1) % 3];
    Face& other = faces_[face.beyond[edge]];
    if (other.visit == visits_) continue;
    if (Above(other, point) <= -tolerance_) {
      horizon_.push_back({face.vertex[edge], to, face.beyond[edge]});
      continue;
    }
    other.visit = visits_;
    seen_.push_back(face.beyond[edge]);
    // Going on from the edge that led here keeps the horizon in order.
    const int entry = other.vertex[0] == to ? 0 : other.vertex[1] == to ? 1 : 2;
    stack_.push_back({face.beyond[edge], entry, 0});
  }
  for (std::size_t i = 0; i < horizon_.size(); ++i)
    if (horizon_[i].to != horizon_[(i + 1) % horizon_.size()].from) return false;
  return horizon_.size() >= 3;
}

void GrowingHull::AddFarthest(int face) {
  const int point = faces_[face].farthest;
  bool good = FindHorizon(face, point);
  fresh_.clear();
  for (const Edge& edge : horizon_)
    good = good && MakeFace(edge.from, edge.to, point, fresh_.emplace_back());
  const int first = static_cast<int>(faces_.size()), count = static_cast<int>(fresh_.size());
  if (!good) seen_ = {face};
  for (int i = 0; good && i < count; ++i) {
    const auto& [from, to, old] = horizon_[i];
    fresh_[i].beyond = {old, first + (i + 1) % count, first + (i + count - 1) % count};
    for (int k = 0; k < 3; ++k)
      if (faces_[old].vertex[k] == to) faces_[old].beyond[k] = first + i;
    faces_.push_back(fresh_[i]);
  }
  if (good) alive_ += count - static_cast<int>(seen_.size());
  for (const int f : seen_) {
    int p = faces_[f].first_outside;
    faces_[f].alive = !good;
    faces_[f].first_outside = faces_[f].farthest = -1;
    faces_[f].distance = 0;
    while (p >= 0) {
      const int next = next_[p];
      if (p != point && good) Assign(p, first);
      if (p != point && !good) Put(p, Above(faces_[f], p), faces_[f]);
      p = next;
    }
  }
}

void GrowingHull::Grow(int max_vertices) {
  if (max_vertices == 0) {  // in any order: points only ever move on to new faces
    for (std::size_t f = 0; f < faces_.size(); ++f)
      while (faces_[f].alive && faces_[f].distance > 0) AddFarthest(static_cast<int>(f));
    return;
  }
  while (solid() && vertices() < max_vertices) {
    const auto best =
        std::max_element(faces_.begin(), faces_.end(),
                         [](const Face& a, const Face& b) { return a.distance < b.distance; });
    if (!(best->distance > 0)) break;
    AddFarthest(static_cast<int>(best - faces_.begin()));
  }
}

double GrowingHull::Volume() const {
  double volume = 0;
  for (const Face& face : faces_) {
    if (!face.alive) continue;
    const Eigen::Vector3d a = points_[face.vertex[0]] - inside_;
    volume +=
        a.dot((points_[face.vertex[1]] - inside_).cross(points_[face.vertex[2]] - inside_)) / 6;
  }
  return volume;
}

TriMesh GrowingHull::Mesh() const {
  std::vector<std::array<int, 3>> triangles;
  for (const Face& face : faces_)
    if (face.alive) triangles.push_back(face.vertex);
  return Compacted(points_, triangles);
}

}  // namespace dexremoe
