#include "eval/label_places.h"

#include <algorithm>
#include <cmath>

namespace dexremoe {
namespace {

struct Box {
  double x, y, half_width, half_height;  // centre and extents
};

double Overlap(const Box& a, const Box& b) {
  const double u = a.half_width + b.half_width - std::abs(a.x - b.x);
  const double v = a.half_height + b.half_height - std::abs(a.y - b.y);
  return u > 0 && v > 0 ? u * v : 0;
}

// Area beyond the canvas.
double Outside(const Box& b, double width, double height) {
  const double u = std::max({0.0, b.half_width - b.x, b.x + b.half_width - width});
  const double v = std::max({0.0, b.half_height - b.y, b.y + b.half_height - height});
  return 2 * (u * b.half_height + v * b.half_width);
}

}  // namespace

std::vector<PlacedLabel> PlaceLabels(const std::vector<double>& x, const std::vector<double>& y,
                                     const std::vector<double>& text_width, double text_height,
                                     double marker_radius, double width, double height) {
  constexpr int kDirections = 16;
  constexpr int kRings = 12;
  constexpr double kOverlapCost = 1e3;  // per square centimetre, against the distance in centimetres
  std::vector<Box> taken;
  for (std::size_t i = 0; i < x.size(); ++i)
    taken.push_back({x[i], y[i], marker_radius, marker_radius});
  std::vector<PlacedLabel> labels;
  for (std::size_t i = 0; i < x.size(); ++i) {
    Box best{x[i], y[i], text_width[i] / 2, text_height / 2};
    double least = HUGE_VAL;
    for (int ring = 0; ring < kRings; ++ring)
      for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * M_PI * k / kDirections;
        const double gap = marker_radius + 0.04 + 0.22 * ring;
        Box box = best;
        box.x = x[i] + std::cos(angle) * (gap + text_width[i] / 2);
        box.y = y[i] + std::sin(angle) * (gap + text_height / 2);
        double cost = gap + kOverlapCost * Outside(box, width, height);
        for (const Box& other : taken) cost += kOverlapCost * Overlap(box, other);
        if (cost < least - 1e-12) {
          least = cost;
          best = box;
        }
      }
    taken.push_back(best);
    labels.push_back({best.x, best.y});
  }
  return labels;
}

}  // namespace dexremoe
