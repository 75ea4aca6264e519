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

constexpr int kDirections = 16;
constexpr int kRings = 12;
constexpr double kRingStep = 0.22;
// Costs against the distance from the point, in the same unit.
constexpr double kOverlapCost = 1e3;  // per area
constexpr double kDotCost = 0.03;     // per dot

double Cost(const Box& box, double gap, const std::vector<Box>& taken, const LabelCanvas& canvas) {
  double cost = gap + kOverlapCost * Outside(box, canvas.width, canvas.height);
  for (const Box& other : taken) cost += kOverlapCost * Overlap(box, other);
  for (std::size_t k = 0; k + 1 < canvas.dots.size(); k += 2)
    if (std::abs(canvas.dots[k] - box.x) < box.half_width &&
        std::abs(canvas.dots[k + 1] - box.y) < box.half_height)
      cost += kDotCost;
  return cost;
}

// Where the line from (x, y) to the middle of the box enters it.
PlacedLabel LabelAt(const Box& box, double x, double y, double gap, double marker_radius) {
  const double dx = box.x - x, dy = box.y - y;
  const double inside = std::min(box.half_width / std::max(std::abs(dx), 1e-12),
                                 box.half_height / std::max(std::abs(dy), 1e-12));
  const double reach = std::max(0.0, 1 - inside);
  return {box.x, box.y, x + reach * dx, y + reach * dy, gap > marker_radius + kRingStep};
}

}  // namespace

std::vector<PlacedLabel> PlaceLabels(const std::vector<LabelRequest>& requests,
                                     const LabelCanvas& canvas) {
  std::vector<Box> taken;
  for (const LabelRequest& r : requests)
    taken.push_back({r.x, r.y, canvas.marker_radius, canvas.marker_radius});
  std::vector<PlacedLabel> labels;
  for (const LabelRequest& r : requests) {
    Box best{r.x, r.y, r.width / 2, canvas.text_height / 2};
    double least = HUGE_VAL, best_gap = 0;
    for (int ring = 0; ring < kRings; ++ring)
      for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * M_PI * k / kDirections;
        const double gap = canvas.marker_radius + 0.03 + kRingStep * ring;
        Box box = best;
        box.x = r.x + std::cos(angle) * (gap + box.half_width);
        box.y = r.y + std::sin(angle) * (gap + box.half_height);
        const double cost = Cost(box, gap, taken, canvas);
        if (cost < least - 1e-12) {
          least = cost;
          best = box;
          best_gap = gap;
        }
      }
    taken.push_back(best);
    labels.push_back(LabelAt(best, r.x, r.y, best_gap, canvas.marker_radius));
  }
  return labels;
}

}  // namespace dexremoe
