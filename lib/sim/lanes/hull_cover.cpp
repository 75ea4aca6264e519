#include "sim/lanes/hull_cover.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "geometry/triangle_bvh.h"
#include "sim/lanes/hull_boxes.h"
#include "sim/lanes/object_surface.h"

namespace dexremoe {
namespace {

using Eigen::Vector3d;

constexpr int kSurfacePoints = 400;
constexpr int kExchangeRounds = 4;  // at most

// What each candidate leaves open of each sample: gap[candidate][sample], m.
using GapTable = std::vector<std::vector<float>>;

GapTable GapsOf(const std::vector<CoverBox>& candidates, const std::vector<Vector3d>& samples) {
  GapTable gaps;
  for (const CoverBox& candidate : candidates) {
    std::vector<float>& row = gaps.emplace_back();
    for (const Vector3d& sample : samples)
      row.push_back(static_cast<float>(std::max(0.0, DistanceTo(candidate.box, sample))));
  }
  return gaps;
}

// Per sample the least gap over the chosen candidates but the one at `without` (-1: all).
std::vector<float> LeastGaps(const GapTable& gaps, const std::vector<int>& chosen, int without) {
  std::vector<float> least(gaps.front().size(), INFINITY);
  for (int k = 0; k < static_cast<int>(chosen.size()); ++k)
    if (k != without)
      for (std::size_t i = 0; i < least.size(); ++i)
        least[i] = std::min(least[i], gaps[chosen[k]][i]);
  return least;
}

double MeanSquare(const std::vector<float>& gaps) {
  double sum = 0;
  for (const double gap : gaps) sum += gap * gap;
  return sum / static_cast<double>(gaps.size());
}

// The candidate that, added to the cover with gaps `least`, leaves the smallest sum of squares.
int BestAddition(const GapTable& gaps, const std::vector<float>& least) {
  int best = -1;
  double best_sum = INFINITY;
  for (std::size_t c = 0; c < gaps.size(); ++c) {
    double sum = 0;
    for (std::size_t i = 0; i < least.size() && sum < best_sum; ++i) {
      const double gap = std::min(least[i], gaps[c][i]);
      sum += gap * gap;
    }
    if (sum < best_sum) {
      best_sum = sum;
      best = static_cast<int>(c);
    }
  }
  return best;
}

std::vector<int> Choose(const GapTable& gaps, const CoverOptions& options) {
  std::vector<int> chosen;
  while (static_cast<int>(chosen.size()) < options.most) {
    const std::vector<float> least = LeastGaps(gaps, chosen, -1);
    if (MeanSquare(least) <= options.gap * options.gap) break;
    chosen.push_back(BestAddition(gaps, least));
  }
  for (int round = 0; round < kExchangeRounds; ++round) {
    bool changed = false;
    for (int k = 0; k < static_cast<int>(chosen.size()); ++k) {
      const int better = BestAddition(gaps, LeastGaps(gaps, chosen, k));
      changed |= better != chosen[k];
      chosen[k] = better;
    }
    if (!changed) break;
  }
  return chosen;
}

}  // namespace

double DistanceTo(const RoundedBox& box, const Vector3d& p) {
  const Vector3d local = box.axes.transpose() * (p - box.center);
  return (local.cwiseAbs() - box.half).cwiseMax(0.0).norm() - box.radius;
}

std::vector<CoverBox> CoverHulls(const ConvexParts& hulls, const CoverOptions& options) {
  DEX_CHECK(!hulls.empty());
  DEX_CHECK_GT(options.most, 0);
  std::vector<CoverBox> candidates;
  for (int i = 0; i < static_cast<int>(hulls.size()); ++i)
    for (const RoundedBox& box : BoxesInside(hulls[i], options)) candidates.push_back({box, i});
  const GapTable gaps = GapsOf(candidates, SpreadOverSurface(UnionSurface(hulls), kSurfacePoints));
  std::vector<CoverBox> cover;
  for (const int c : Choose(gaps, options)) cover.push_back(candidates[c]);
  return cover;
}

}  // namespace dexremoe
