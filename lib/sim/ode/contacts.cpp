#include "sim/ode/contacts.h"

#include <algorithm>

#include "sim/sim_shared.h"

namespace dexremoe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSameSpot = 1.5e-3;  // m
constexpr double kSameNormal = 0.9;   // cosine

PlacedShape Place(const ContactModel::HandShape& collider, const LinkPose& X_WL) {
  PlacedShape placed;
  placed.shape = &collider.shape;
  placed.R = X_WL.R * collider.X_LC.q.toRotationMatrix();
  placed.p = X_WL.R * collider.X_LC.p + X_WL.p;
  return placed;
}

// Half the extent along each axis of the box around a placed shape.
Vector3d HalfExtent(const PlacedShape& placed) {
  const Vector3d half = 0.5 * placed.shape->box.Size();
  return placed.R.cwiseAbs() * half + Vector3d::Constant(placed.shape->radius);
}

bool BoxesApart(const Vector3d& center, const Vector3d& half, const ConvexShape& part, double scale,
                double margin) {
  const Vector3d part_center = scale * part.box.Center();
  const Vector3d reach = 0.5 * scale * part.box.Size() + half;
  return ((part_center - center).cwiseAbs() - reach).maxCoeff() > margin;
}

bool SpheresApart(const PlacedShape& a, const PlacedShape& b, double margin) {
  const double reach = a.shape->bound * a.scale + b.shape->bound * b.scale + margin;
  return (a.Place(a.shape->center) - b.Place(b.shape->center)).squaredNorm() > reach * reach;
}

}  // namespace

ContactModel::ObjectShape ShapeOfObject(const ConvexParts& parts, const std::string& name) {
  ContactModel::ObjectShape object;
  for (const TriMesh& part : parts) {
    const std::string what = "object " + name + ": part " + std::to_string(object.parts.size());
    object.parts.push_back(ShapeOfHull(part, what));
    for (const Vector3d& vertex : part.vertices)
      object.radius = std::max(object.radius, vertex.norm());
  }
  return object;
}

ContactModel ContactModelOf(const HandModel& hand) {
  ContactModel model;
  for (const Collider& collider : hand.colliders)
    model.hand.push_back({ShapeOfCollider(collider), collider.link, collider.X_LC});
  model.hand_pairs = SelfContactPairs(hand);
  return model;
}

const std::vector<ContactPoint>& ContactFinder::ObjectContacts(const std::vector<LinkPose>& links,
                                                               int object, double scale,
                                                               const LinkPose& X_WO, double margin,
                                                               int max_points) {
  points_.clear();
  object_ = &model_.objects[object];
  const double reach = object_->radius * scale + margin;
  for (std::size_t i = 0; i < model_.hand.size(); ++i) {
    const ContactModel::HandShape& collider = model_.hand[i];
    PlacedShape placed = Place(collider, links[collider.link]);
    const Vector3d offset = placed.Place(collider.shape.center) - X_WO.p;
    const double apart = reach + collider.shape.bound;
    if (offset.squaredNorm() > apart * apart) continue;
    // The pair is worked out in O, where the object's parts are constants.
    placed.R = X_WO.R.transpose() * placed.R;
    placed.p = X_WO.R.transpose() * (placed.p - X_WO.p);
    AddColliderContacts(static_cast<int>(i), placed, scale, X_WO, margin);
  }
  Limit(max_points);
  return points_;
}

void ContactFinder::AddColliderContacts(int collider, const PlacedShape& placed, double scale,
                                        const LinkPose& X_WO, double margin) {
  const Vector3d center = placed.Place(placed.shape->box.Center()), half = HalfExtent(placed);
  const std::size_t first = points_.size();
  for (const ConvexShape& shape : object_->parts) {
    if (BoxesApart(center, half, shape, scale, margin)) continue;
    PlacedShape part;
    part.shape = &shape;
    part.scale = scale;
    part.identity = true;
    const Manifold manifold = FindManifold(part, placed, margin);
    const Vector3d normal = X_WO.R * manifold.normal;
    for (int k = 0; k < manifold.size; ++k) {
      ContactPoint point;
      point.position = X_WO.R * manifold.point[k].position + X_WO.p;
      point.normal = normal;
      point.gap = manifold.point[k].gap;
      point.collider = collider;
      // Overlapping parts of one object meet a collider in the same spot: keep the deeper point.
      bool repeated = false;
      for (std::size_t j = first; j < points_.size() && !repeated; ++j) {
        if ((points_[j].position - point.position).squaredNorm() > kSameSpot * kSameSpot) continue;
        if (points_[j].normal.dot(normal) < kSameNormal) continue;
        repeated = true;
        if (point.gap < points_[j].gap) points_[j] = point;
      }
      if (!repeated) points_.push_back(point);
    }
  }
}

// Keeps the deepest point of every collider, then the deepest of all.
void ContactFinder::Limit(int max_points) {
  if (static_cast<int>(points_.size()) <= max_points) return;
  std::stable_sort(points_.begin(), points_.end(),
                   [](const ContactPoint& a, const ContactPoint& b) { return a.gap < b.gap; });
  const auto is_first = [this](const ContactPoint& point) {
    for (const ContactPoint* other = points_.data(); other != &point; ++other)
      if (other->collider == point.collider) return false;
    return true;
  };
  std::vector<ContactPoint> kept, rest;
  for (const ContactPoint& point : points_) (is_first(point) ? kept : rest).push_back(point);
  kept.insert(kept.end(), rest.begin(), rest.end());
  kept.resize(max_points);
  points_ = std::move(kept);
}

const std::vector<ContactPoint>& ContactFinder::SelfContacts(const std::vector<LinkPose>& links,
                                                             double margin) {
  self_points_.clear();
  for (const auto& [i, j] : model_.hand_pairs) {
    const PlacedShape a = Place(model_.hand[i], links[model_.hand[i].link]);
    const PlacedShape b = Place(model_.hand[j], links[model_.hand[j].link]);
    if (SpheresApart(a, b, margin)) continue;
    const Manifold manifold = FindManifold(a, b, margin);
    for (int k = 0; k < manifold.size; ++k) {
      ContactPoint point;
      point.position = manifold.point[k].position;
      point.normal = manifold.normal;
      point.gap = manifold.point[k].gap;
      point.collider = j;
      point.other = i;
      self_points_.push_back(point);
    }
  }
  return self_points_;
}

}  // namespace dexremoe
