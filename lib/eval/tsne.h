// t-SNE (van der Maaten and Hinton 2008): points of many dimensions laid out in the plane so that
// near neighbours stay near. Distances between clusters and their sizes carry no meaning; read the
// neighbour preservation beside the picture.
//
// Exact: all N^2 pairs, no tree. Results do not depend on the number of workers.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/options.h"
#include "base/thread_pool.h"

namespace dexremoe {

struct TsneOptions {
  double perplexity = 30;  // capped at (N - 1) / 3
  int iterations = 1000;
  double exaggeration = 12;  // factor on the affinities during the first iterations
  int exaggeration_iterations = 250;
  double learning_rate = 0;         // 0 = N / exaggeration / 4, at least 50 (Belkina et al. 2019)
  void Register(Options& options);  // section "tsne"
};

struct TsneResult {
  std::vector<double> position;  // [N, 2], centred
  double kl = 0;                 // nats
  double perplexity = 0;         // as used
  int distinct = 0;              // rows that were embedded; equal rows share a position
};

// x [n, d] row-major, finite; n >= 1. `progress` gets the iterations done. Throws Error when x
// holds something else.
TsneResult Tsne(const std::vector<double>& x, int n, int d, const TsneOptions& options,
                std::uint64_t seed, ThreadPool& pool,
                const std::function<void(int done)>& progress = {});

// The pieces, for tests.

// Symmetric affinities P [n, n], sum 1, zero diagonal: each row's Gaussian has the width at which
// its entropy is log(perplexity). Rows must differ.
std::vector<float> Affinities(const std::vector<double>& x, int n, int d, double perplexity,
                              ThreadPool& pool);

// Gradient of KL(exaggeration * P || Q) by the positions y [n, 2] into `gradient`, with
// Q from Student's t of one degree of freedom.
void TsneGradient(const std::vector<float>& p, const std::vector<double>& y, int n,
                  double exaggeration, std::vector<double>& gradient, ThreadPool& pool);

// KL(P || Q), nats.
double TsneDivergence(const std::vector<float>& p, const std::vector<double>& y, int n,
                      ThreadPool& pool);

}  // namespace dexremoe
