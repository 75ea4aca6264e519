#include "eval/neighbours.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/check.h"
#include "base/random.h"

namespace dexremoe {
namespace {

constexpr int kChunks = 64;

double SquaredDistance(const double* a, const double* b, int d) {
  double sum = 0;
  for (int k = 0; k < d; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

// All other points by distance from point i, nearest first.
std::vector<int> Order(const std::vector<double>& x, int n, int d, int i) {
  std::vector<double> distance(n);
  for (int j = 0; j < n; ++j) distance[j] = SquaredDistance(&x[i * d], &x[j * d], d);
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  order.erase(order.begin() + i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return distance[a] != distance[b] ? distance[a] < distance[b] : a < b;
  });
  return order;
}

// k-means++ (Arthur and Vassilvitskii 2007): each next centre is drawn with a chance proportional
// to its squared distance from the nearest one so far. Returns [k, d].
std::vector<double> DrawCentres(const std::vector<double>& x, int n, int d, int k, Rng& rng) {
  std::vector<double> centre, nearest(n, HUGE_VAL);
  int pick = static_cast<int>(rng.Index(n));
  for (int c = 0; c < k; ++c) {
    centre.insert(centre.end(), x.begin() + pick * d, x.begin() + (pick + 1) * d);
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      nearest[i] = std::min(nearest[i], SquaredDistance(&x[i * d], &centre[c * d], d));
      sum += nearest[i];
    }
    double left = rng.Uniform() * sum;
    pick = 0;
    while (pick + 1 < n && (left -= nearest[pick]) >= 0) ++pick;
  }
  return centre;
}

// Gives every point its nearest centre; returns the sum of squared distances.
double Assign(const std::vector<double>& x, int n, int d, const std::vector<double>& centre,
              std::vector<int>& label) {
  double total = 0;
  for (int i = 0; i < n; ++i) {
    double least = HUGE_VAL;
    for (int c = 0; c * d < static_cast<int>(centre.size()); ++c) {
      const double distance = SquaredDistance(&x[i * d], &centre[c * d], d);
      if (distance >= least) continue;
      least = distance;
      label[i] = c;
    }
    total += least;
  }
  return total;
}

// Moves each centre to the mean of its points; one without points stays.
void MoveCentres(const std::vector<double>& x, int n, int d, const std::vector<int>& label,
                 std::vector<double>& centre) {
  std::vector<double> sum(centre.size(), 0.0);
  std::vector<int> count(centre.size() / d, 0);
  for (int i = 0; i < n; ++i) {
    ++count[label[i]];
    for (int a = 0; a < d; ++a) sum[label[i] * d + a] += x[i * d + a];
  }
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k / d] > 0) centre[k] = sum[k] / count[k / d];
}

// Lloyd's algorithm until nothing moves. Returns the sum of squared distances.
double Lloyd(const std::vector<double>& x, int n, int d, int k, Rng& rng, std::vector<int>& label) {
  std::vector<double> centre = DrawCentres(x, n, d, k, rng);
  label.assign(n, 0);
  double total = Assign(x, n, d, centre, label);
  for (std::vector<int> before; before != label;) {
    before = label;
    MoveCentres(x, n, d, label, centre);
    total = Assign(x, n, d, centre, label);
  }
  return total;
}

// Mean silhouette; points alone in their cluster count 0.
double Silhouette(const std::vector<double>& x, int n, int d, int k,
                  const std::vector<int>& label) {
  std::vector<int> count(k, 0);
  for (const int c : label) ++count[c];
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    if (count[label[i]] < 2) continue;
    std::vector<double> mean(k, 0.0);
    for (int j = 0; j < n; ++j)
      mean[label[j]] += std::sqrt(SquaredDistance(&x[i * d], &x[j * d], d));
    double within = 0, nearest = HUGE_VAL;
    for (int c = 0; c < k; ++c) {
      if (c == label[i])
        within = mean[c] / (count[c] - 1);
      else if (count[c] > 0)
        nearest = std::min(nearest, mean[c] / count[c]);
    }
    const double larger = std::max(within, nearest);
    if (larger > 0 && std::isfinite(nearest)) sum += (nearest - within) / larger;
  }
  return sum / n;
}

// Renumbers clusters by size, largest first; equal sizes by their first point.
void SortBySize(int k, std::vector<int>& label) {
  std::vector<int> count(k, 0), first(k, static_cast<int>(label.size())), order(k), rank(k);
  for (std::size_t i = 0; i < label.size(); ++i) {
    ++count[label[i]];
    first[label[i]] = std::min(first[label[i]], static_cast<int>(i));
  }
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return count[a] != count[b] ? count[a] > count[b] : first[a] < first[b];
  });
  for (int c = 0; c < k; ++c) rank[order[c]] = c;
  for (int& c : label) c = rank[c];
}

}  // namespace

NeighbourPreservation ComparePositions(const std::vector<double>& x, int n, int d,
                                       const std::vector<double>& y, int e, int k,
                                       ThreadPool& pool) {
  DEX_CHECK_GE(k, 1);
  DEX_CHECK_LT(2 * k, n);
  std::vector<double> kept(kChunks, 0.0), penalty(kChunks, 0.0);
  pool.ParallelFor(kChunks, [&](int chunk, int) {
    const auto begin = static_cast<int>(static_cast<std::int64_t>(chunk) * n / kChunks);
    const auto end = static_cast<int>(static_cast<std::int64_t>(chunk + 1) * n / kChunks);
    std::vector<int> rank(n);
    for (int i = begin; i < end; ++i) {
      const std::vector<int> before = Order(x, n, d, i), after = Order(y, n, e, i);
      for (int r = 0; r + 1 < n; ++r) rank[before[r]] = r + 1;
      for (int r = 0; r < k; ++r) {
        const int excess = rank[after[r]] - k;
        if (excess <= 0)
          kept[chunk] += 1;
        else
          penalty[chunk] += excess;
      }
    }
  });
  double sum_kept = 0, sum_penalty = 0;
  for (int c = 0; c < kChunks; ++c) {
    sum_kept += kept[c];
    sum_penalty += penalty[c];
  }
  const double pairs = static_cast<double>(n) * k;
  return {sum_kept / pairs, 1 - 2 * sum_penalty / (pairs * (2.0 * n - 3.0 * k - 1))};
}

Clustering ClusterPoints(const std::vector<double>& x, int n, int d, int most, std::uint64_t seed) {
  std::set<std::vector<double>> distinct;
  for (int i = 0; i < n; ++i) distinct.emplace(x.begin() + i * d, x.begin() + (i + 1) * d);
  Clustering best{1, std::vector<int>(n, 0), 0};
  bool any = false;
  for (int k = 2; k <= most && k < static_cast<int>(distinct.size()); ++k) {
    std::vector<int> label, trial;
    double least = HUGE_VAL;
    for (std::uint64_t start = 0; start < 20; ++start) {
      Rng rng(seed, Stream::kEmbed, {static_cast<std::uint64_t>(k), start});
      const double total = Lloyd(x, n, d, k, rng, trial);
      if (total < least) {
        least = total;
        label = trial;
      }
    }
    const double silhouette = Silhouette(x, n, d, k, label);
    if (any && silhouette <= best.silhouette) continue;
    any = true;
    SortBySize(k, label);
    best = {k, label, silhouette};
  }
  return best;
}

}  // namespace dexremoe
