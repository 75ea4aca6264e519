#include "eval/tsne.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/check.h"
#include "base/error.h"
#include "base/random.h"

namespace dexremoe {
namespace {

// Rows are dealt to this many chunks whatever the number of workers; sums go in chunk order.
constexpr int kChunks = 64;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

int ChunkBegin(int chunk, int n) {
  return static_cast<int>(static_cast<std::int64_t>(chunk) * n / kChunks);
}

void ForRows(int n, ThreadPool& pool, const std::function<void(int chunk, int begin, int end)>& f) {
  pool.ParallelFor(
      kChunks, [&](int chunk, int) { f(chunk, ChunkBegin(chunk, n), ChunkBegin(chunk + 1, n)); });
}

// Conditional affinities of one row from squared distances (d2[i] is ignored): the precision is
// found by bisection on the entropy.
void ConditionalRow(const std::vector<double>& d2, int i, double perplexity,
                    std::vector<double>& p) {
  const int n = static_cast<int>(d2.size());
  double nearest = HUGE_VAL;
  for (int j = 0; j < n; ++j)
    if (j != i) nearest = std::min(nearest, d2[j]);
  const double wanted = std::log(perplexity);
  double beta = 1 / std::max(nearest, 1e-300), low = 0, high = HUGE_VAL;
  for (int step = 0; step < 200; ++step) {
    double sum = 0, moment = 0;
    for (int j = 0; j < n; ++j) {
      // Shifted by the nearest, so that the largest term is 1.
      p[j] = j == i ? 0 : std::exp(-beta * (d2[j] - nearest));
      sum += p[j];
      moment += p[j] * (d2[j] - nearest);
    }
    const double entropy = std::log(sum) + beta * moment / sum;
    for (double& x : p) x /= sum;
    if (std::abs(entropy - wanted) < 1e-10) return;
    (entropy > wanted ? low : high) = beta;
    beta = std::isinf(high) ? 2 * beta : 0.5 * (low + high);
  }
}

// First two principal components, the first scaled to a standard deviation of 1e-4 (Kobak and
// Berens 2019). A little noise keeps data on a line from staying there.
std::vector<double> PcaStart(const std::vector<double>& x, int n, int d, std::uint64_t seed) {
  const Eigen::Map<const RowMajor> rows(x.data(), n, d);
  const RowMajor centred = rows.rowwise() - rows.colwise().mean();
  const Eigen::MatrixXd covariance = centred.transpose() * centred / n;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  Rng rng(seed, Stream::kEmbed);
  std::vector<double> y(2 * static_cast<std::size_t>(n));
  const double deviation = std::sqrt(std::max(solver.eigenvalues()[d - 1], 1e-300));
  for (int k = 0; k < 2; ++k) {
    if (k < d) {
      Eigen::VectorXd axis = solver.eigenvectors().col(d - 1 - k);
      Eigen::Index largest = 0;
      axis.cwiseAbs().maxCoeff(&largest);
      if (axis[largest] < 0) axis = -axis;  // the sign of an eigenvector is arbitrary
      const Eigen::VectorXd score = centred * axis;
      for (int i = 0; i < n; ++i) y[2 * i + k] = 1e-4 * score[i] / deviation;
    }
    for (int i = 0; i < n; ++i) y[2 * i + k] += 1e-6 * rng.Normal();
  }
  return y;
}

// Gradient descent with momentum and a gain per coordinate (Jacobs 1988), as in the authors' code.
class Descent {
 public:
  Descent(std::size_t size, double rate) : rate_(rate), velocity_(size, 0), gain_(size, 1) {}

  void Step(const std::vector<double>& gradient, double momentum, std::vector<double>& y) {
    for (std::size_t k = 0; k < y.size(); ++k) {
      const bool same_sign = (gradient[k] > 0) == (velocity_[k] > 0);
      gain_[k] = std::max(0.01, same_sign ? 0.8 * gain_[k] : gain_[k] + 0.2);
      velocity_[k] = momentum * velocity_[k] - rate_ * gain_[k] * gradient[k];
      y[k] += velocity_[k];
    }
  }

 private:
  double rate_;
  std::vector<double> velocity_, gain_;
};

void Centre(std::vector<double>& y) {
  double mean[2] = {0, 0};
  for (std::size_t k = 0; k < y.size(); ++k) mean[k % 2] += y[k];
  for (double& m : mean) m /= static_cast<double>(y.size() / 2);
  for (std::size_t k = 0; k < y.size(); ++k) y[k] -= mean[k % 2];
}

// Rows that are equal to 1e-6 of the data's spread count as one: zero distances have no Gaussian of
// the wanted perplexity. Returns the index of each row's representative in `distinct`.
std::vector<int> MergeEqualRows(const std::vector<double>& x, int n, int d,
                                std::vector<double>& distinct) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const double value : x) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  const double grain = std::max((high - low) * 1e-6, 1e-300);
  std::map<std::vector<std::int64_t>, int> known;
  std::vector<int> index(n);
  for (int i = 0; i < n; ++i) {
    std::vector<std::int64_t> key(d);
    for (int k = 0; k < d; ++k) key[k] = std::llround((x[i * d + k] - low) / grain);
    const auto [found, fresh] = known.emplace(std::move(key), static_cast<int>(known.size()));
    if (fresh) distinct.insert(distinct.end(), x.begin() + i * d, x.begin() + (i + 1) * d);
    index[i] = found->second;
  }
  return index;
}

// Attraction and repulsion (see TsneGradient) of `size` points on the point (u, v); returns the sum
// of t. A block's arrays stay in the first-level cache.
constexpr int kBlock = 512;

double AddForces(const float* p, float u, float v, const float* us, const float* vs, int size,
                 double* force) {
  using Block = Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1>;
  using Input = Eigen::Map<const Eigen::ArrayXf>;
  const Block du = u - Input(us, size), dv = v - Input(vs, size);
  const Block t = (1 + du * du + dv * dv).inverse();
  const Block w = Input(p, size) * t;
  force[0] += static_cast<double>((w * du).sum());
  force[1] += static_cast<double>((w * dv).sum());
  force[2] += static_cast<double>((t * t * du).sum());
  force[3] += static_cast<double>((t * t * dv).sum());
  return static_cast<double>(t.sum());
}

}  // namespace

void TsneOptions::Register(Options& options) {
  options.Add("tsne.perplexity", &perplexity, "effective number of neighbours; at most (N - 1) / 3")
      .Range(2, 1000);
  options.Add("tsne.iterations", &iterations, "gradient steps").Range(1, 1e6);
  options.Add("tsne.exaggeration", &exaggeration, "factor on the affinities at first")
      .Range(1, 100);
  options.Add("tsne.exaggeration_iterations", &exaggeration_iterations, "how long").Range(0, 1e6);
  options.Add("tsne.learning_rate", &learning_rate, "0 = N / exaggeration / 4, at least 50")
      .Range(0, 1e6);
}

std::vector<float> Affinities(const std::vector<double>& x, int n, int d, double perplexity,
                              ThreadPool& pool) {
  DEX_CHECK_GE(n, 2);
  const auto size = static_cast<std::size_t>(n);
  std::vector<float> conditional(size * size), p(size * size);
  ForRows(n, pool, [&](int, int begin, int end) {
    std::vector<double> d2(n), row(n);
    for (int i = begin; i < end; ++i) {
      for (int j = 0; j < n; ++j) {
        d2[j] = 0;
        for (int k = 0; k < d; ++k) {
          const double difference = x[i * d + k] - x[j * d + k];
          d2[j] += difference * difference;
        }
      }
      ConditionalRow(d2, i, perplexity, row);
      // Far points count nothing; their denormal numbers would only slow the sums down.
      for (std::size_t j = 0; j < size; ++j)
        conditional[i * size + j] = row[j] < 1e-30 ? 0.0f : static_cast<float>(row[j]);
    }
  });
  ForRows(n, pool, [&](int, int begin, int end) {
    for (std::size_t i = begin; i < static_cast<std::size_t>(end); ++i)
      for (std::size_t j = 0; j < size; ++j)
        p[i * size + j] = (conditional[i * size + j] + conditional[j * size + i]) / (2.0f * n);
  });
  return p;
}

void TsneGradient(const std::vector<float>& p, const std::vector<double>& y, int n,
                  double exaggeration, std::vector<double>& gradient, ThreadPool& pool) {
  // Attraction sum_j p_ij t_ij (y_i - y_j) and repulsion sum_j t_ij^2 (y_i - y_j) in one pass, with
  // t = 1 / (1 + |y_i - y_j|^2); the normaliser of Q is known only at its end.
  const Eigen::Map<const Eigen::Array2Xd> points(y.data(), 2, n);
  const Eigen::ArrayXf u = points.row(0).cast<float>(), v = points.row(1).cast<float>();
  Eigen::Array4Xd forces = Eigen::Array4Xd::Zero(4, n);  // attraction u, v; repulsion u, v
  std::vector<double> normaliser(kChunks, 0.0);
  ForRows(n, pool, [&](int chunk, int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const float* row = p.data() + static_cast<std::size_t>(i) * n;
      normaliser[chunk] -= 1;  // j = i does not count
      for (int j = 0; j < n; j += kBlock) {
        const int size = std::min(kBlock, n - j);
        normaliser[chunk] +=
            AddForces(row + j, u[i], v[i], u.data() + j, v.data() + j, size, forces.data() + 4 * i);
      }
    }
  });
  double z = 0;
  for (const double part : normaliser) z += part;
  gradient.resize(2 * static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 2; ++k)
      gradient[2 * i + k] = 4 * (exaggeration * forces(k, i) - forces(k + 2, i) / z);
}

double TsneDivergence(const std::vector<float>& p, const std::vector<double>& y, int n,
                      ThreadPool& pool) {
  // sum p log(p / q) = sum p log(p / t) + log(sum t), as the sum of p is 1.
  std::vector<double> cross(kChunks, 0.0), normaliser(kChunks, 0.0);
  ForRows(n, pool, [&](int chunk, int begin, int end) {
    for (int i = begin; i < end; ++i)
      for (int j = 0; j < n; ++j) {
        if (j == i) continue;
        const double du = y[2 * i] - y[2 * j], dv = y[2 * i + 1] - y[2 * j + 1];
        const double t = 1 / (1 + du * du + dv * dv);
        const double pij = p[static_cast<std::size_t>(i) * n + j];
        normaliser[chunk] += t;
        if (pij > 0) cross[chunk] += pij * std::log(pij / t);
      }
  });
  double z = 0, sum = 0;
  for (int c = 0; c < kChunks; ++c) {
    z += normaliser[c];
    sum += cross[c];
  }
  return sum + std::log(z);
}

TsneResult Tsne(const std::vector<double>& x, int n, int d, const TsneOptions& options,
                std::uint64_t seed, ThreadPool& pool, const std::function<void(int)>& progress) {
  DEX_CHECK_EQ(x.size(), static_cast<std::size_t>(n) * static_cast<std::size_t>(d));
  for (std::size_t k = 0; k < x.size(); ++k)
    if (!std::isfinite(x[k])) Fail("t-SNE: row {}: expected finite numbers, found {}", k / d, x[k]);
  TsneResult result;
  std::vector<double> rows;
  const std::vector<int> index = MergeEqualRows(x, n, d, rows);
  const int m = static_cast<int>(rows.size()) / d;
  result.distinct = m;
  result.perplexity = std::min(options.perplexity, (m - 1) / 3.0);
  result.position.assign(2 * static_cast<std::size_t>(n), 0.0);
  if (m < 4) Fail("t-SNE: expected at least 4 distinct rows, found {}", m);
  const std::vector<float> p = Affinities(rows, m, d, result.perplexity, pool);
  std::vector<double> y = PcaStart(rows, m, d, seed), gradient;
  const double rate = options.learning_rate > 0 ? options.learning_rate
                                                : std::max(50.0, m / options.exaggeration / 4);
  Descent descent(y.size(), rate);
  for (int step = 0; step < options.iterations; ++step) {
    const bool early = step < options.exaggeration_iterations;
    TsneGradient(p, y, m, early ? options.exaggeration : 1, gradient, pool);
    descent.Step(gradient, early ? 0.5 : 0.8, y);
    if (progress) progress(step + 1);
  }
  Centre(y);
  result.kl = TsneDivergence(p, y, m, pool);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 2; ++k) result.position[2 * i + k] = y[2 * index[i] + k];
  return result;
}

}  // namespace dexremoe
