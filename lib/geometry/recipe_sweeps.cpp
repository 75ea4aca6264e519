// Shapes that follow a line: tubes, lofts, wings and extruded outlines.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/recipe_shapes.h"

namespace dexremoe {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// A piece of a tube: distance to the segment less the radius interpolated along it.
double SegmentDistance(const Vector3d& p, const Vector4d& a, const Vector4d& b) {
  const Vector3d axis = (b - a).head<3>(), from_a = p - a.head<3>();
  const double squared = axis.squaredNorm();
  const double t = squared > 0 ? std::clamp(from_a.dot(axis) / squared, 0.0, 1.0) : 0;
  return (from_a - t * axis).norm() - (a[3] + t * (b[3] - a[3]));
}

// Uniform Catmull-Rom curve through the points, `pieces` segments between neighbours.
std::vector<Vector4d> CatmullRom(const std::vector<Vector4d>& points, int pieces) {
  const int n = static_cast<int>(points.size());
  std::vector<Vector4d> curve = {points[0]};
  for (int i = 0; i + 1 < n; ++i) {
    const Vector4d& p1 = points[i];
    const Vector4d& p2 = points[i + 1];
    const Vector4d m1 = i > 0 ? Vector4d((p2 - points[i - 1]) / 2) : Vector4d(p2 - p1);
    const Vector4d m2 = i + 2 < n ? Vector4d((points[i + 2] - p1) / 2) : Vector4d(p2 - p1);
    for (int k = 1; k <= pieces; ++k) {
      const double t = static_cast<double>(k) / pieces, t2 = t * t, t3 = t2 * t;
      curve.emplace_back((2 * t3 - 3 * t2 + 1) * p1 + (t3 - 2 * t2 + t) * m1 +
                         (3 * t2 - 2 * t3) * p2 + (t3 - t2) * m2);
    }
  }
  return curve;
}

// Cross-section of a loft at one place.
struct Section {
  double z, width, up, down, power;
};
constexpr int kChannels = 5;

// Smooth curves through station values over x that never overshoot (Fritsch and Butland 1984).
class Stations {
 public:
  explicit Stations(const std::vector<std::vector<double>>& rows) {
    for (const auto& row : rows) {
      x_.push_back(row[0]);
      const double down = row.size() > 4 ? row[4] : row[3];
      values_.push_back({row[1], row[2], row[3], down, row.size() > 5 ? row[5] : 2.0});
    }
    for (std::size_t i = 0; i < x_.size(); ++i) slopes_.push_back(SlopesAt(i));
  }
  double low() const { return x_.front(); }
  double high() const { return x_.back(); }

  Section At(double x) const {
    x = std::clamp(x, low(), high());
    const auto upper = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
    const std::size_t i = static_cast<std::size_t>(upper - x_.begin()) - 1;
    const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h, t2 = t * t, t3 = t2 * t;
    std::array<double, kChannels> v;
    for (int c = 0; c < kChannels; ++c)
      v[c] = (2 * t3 - 3 * t2 + 1) * values_[i][c] + (t3 - 2 * t2 + t) * h * slopes_[i][c] +
             (3 * t2 - 2 * t3) * values_[i + 1][c] + (t3 - t2) * h * slopes_[i + 1][c];
    return {v[0], v[1], v[2], v[3], v[4]};
  }

 private:
  std::array<double, kChannels> SlopesAt(std::size_t i) const {
    std::array<double, kChannels> slopes{};
    const std::size_t n = x_.size();
    for (int c = 0; c < kChannels; ++c) {
      const auto rise = [&](std::size_t k) {
        return (values_[k + 1][c] - values_[k][c]) / (x_[k + 1] - x_[k]);
      };
      if (i == 0 || i + 1 == n) {
        slopes[c] = rise(i == 0 ? 0 : n - 2);
        continue;
      }
      const double a = rise(i - 1), b = rise(i);
      slopes[c] = a * b > 0 ? 2 * a * b / (a + b) : 0;
    }
    return slopes;
  }
  std::vector<double> x_;
  std::vector<std::array<double, kChannels>> values_, slopes_;
};

// Exact signed distance to a polygon (Quilez); negative inside whatever its orientation.
double PolygonDistance(const std::vector<Vector2d>& polygon, const Vector2d& p) {
  double squared = INFINITY;
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vector2d &a = polygon[i], &b = polygon[j];
    const Vector2d edge = b - a, from_a = p - a;
    const double t = std::clamp(from_a.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    squared = std::min(squared, (from_a - t * edge).squaredNorm());
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + edge.x() * (p.y() - a.y()) / edge.y())
      inside = !inside;
  }
  return inside ? -std::sqrt(squared) : std::sqrt(squared);
}

// Distance to the intersection of two slabs whose distances are a and b, at right angles.
double Corner(double a, double b) {
  return std::min(std::max(a, b), 0.0) + std::hypot(std::max(a, 0.0), std::max(b, 0.0));
}

}  // namespace

Field MakeTube(RecipeArgs& args) {
  std::vector<Vector4d> points;
  for (const auto& row : args.List("points", 2, 4, 4)) {
    points.emplace_back(row.data());
    if (!(row[3] > 0)) args.place().Fail("points: expected radii above 0, found {}", row[3]);
  }
  constexpr int kPieces = 6;
  if (args.Number("straight", 0) == 0) points = CatmullRom(points, kPieces);
  return [points](const Vector3d& p) {
    double distance = INFINITY;
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
      distance = std::min(distance, SegmentDistance(p, points[i], points[i + 1]));
    return distance;
  };
}

Field MakeLoft(RecipeArgs& args) {
  const auto rows = args.List("stations", 2, 4, 6);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && !(rows[i][0] > rows[i - 1][0]))
      args.place().Fail("stations: expected rising x, found {} after {}", rows[i][0],
                        rows[i - 1][0]);
    for (std::size_t k = 2; k < rows[i].size(); ++k)
      if (!(rows[i][k] > 0))
        args.place().Fail("stations: expected sizes above 0, found {}", rows[i][k]);
  }
  const double round = args.Number("round", 0);
  return [stations = Stations(rows), round](const Vector3d& p) {
    const Section s = stations.At(p.x());
    const double z = p.z() - s.z;
    const double aside = SuperellipseDistance(p.y(), z, s.width, z > 0 ? s.up : s.down, s.power);
    const double beyond = std::max(stations.low() - p.x(), p.x() - stations.high());
    return round > 0 ? -SmoothMin(-aside, -beyond, round) : Corner(aside, beyond);
  };
}

Field MakeWing(RecipeArgs& args) {
  const Vector3d root = args.Vector("root"), tip = args.Vector("tip");
  const Vector2d chord = args.Pair("chord"), thick = args.Pair("thick");
  const double power = args.Positive("power", 2);
  Vector3d span = tip - root;
  const double sweep = span.x();
  span.x() = 0;
  const double length = span.norm();
  if (!(length > 0) || !(chord.minCoeff() > 0) || !(thick.minCoeff() > 0))
    args.place().Fail("wing: expected root and tip apart in y or z, chord and thick above 0");
  const Vector3d along = span / length, across = Vector3d::UnitX().cross(along);
  return [=](const Vector3d& p) {
    const double s = (p - root).dot(along), t = std::clamp(s / length, 0.0, 1.0);
    const double half = (chord[0] + t * (chord[1] - chord[0])) / 2;
    const double x = p.x() - (root.x() + t * sweep - half);
    const double aside = SuperellipseDistance(x, (p - root).dot(across), half,
                                              (thick[0] + t * (thick[1] - thick[0])) / 2, power);
    // Rounded at the tip by its thickness.
    return -SmoothMin(-aside, -std::max(-s, s - length), thick[1]);
  };
}

Field MakeExtrusion(RecipeArgs& args) {
  std::vector<Vector2d> polygon;
  for (const auto& row : args.List("outline", 3, 2, 2)) polygon.emplace_back(row.data());
  const double half = args.Positive("width") / 2, round = args.Number("round", 0);
  if (round < 0 || round >= half)
    args.place().Fail("round: expected 0 to less than half of width, found {}", round);
  return [=](const Vector3d& p) {
    const double aside = PolygonDistance(polygon, {p.x(), p.z()}) + round;
    return Corner(aside, std::abs(p.y()) - half + round) - round;
  };
}

}  // namespace dexremoe
