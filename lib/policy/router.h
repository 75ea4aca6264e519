// Which experts act on a row, and how much: what sets sparse mixtures apart.
//
// Routers compute in W = Wide<T> of the policy, never in bfloat16: near-ties between experts decide
// where a row goes (Fedus et al. 2021, section 2.4). Shapes: n rows, d inputs, E experts.
#pragma once

#include <cstdint>
#include <vector>

#include "base/random.h"
#include "nn/params.h"
#include "policy/policy.h"

namespace dexremoe {

template <typename W>
struct RouterRows {
  std::int64_t n = 0;
  const W* input = nullptr;  // [n, d]
  const W* noise = nullptr;  // [n, noise_size()], or null for none
};

template <typename W>
class Router {
 public:
  virtual ~Router() = default;

  virtual void Initialize(Rng& rng, float* params) const = 0;
  virtual int noise_size() const = 0;
  virtual void DrawNoise(Rng& rng, float* noise) const = 0;
  // Elements that Forward keeps of n rows for Balance and Backward.
  virtual std::int64_t PassSize(std::int64_t n) const = 0;
  // weights [n, E] is set; 0 where an expert does not act.
  virtual void Forward(const W* params, const RouterRows<W>& rows, W* pass, W* weights) const = 0;
  // After Forward, [n, E]: what the routing's entropy is taken of, a row relative to its sum.
  virtual const W* Shares(std::int64_t, const W* weights, W*) const { return weights; }
  // The router's own loss over these rows; Backward will add `weight` times its gradient.
  virtual double Balance(const RouterRows<W>& rows, const W* weights, W weight, W* pass) const = 0;
  // Adds to grads; dinput [n, d] is set. dweights [n, E]: only those of acting experts count.
  virtual void Backward(const W* params, const RouterRows<W>& rows, const W* weights,
                        const W* dweights, W* pass, W* dinput, W* grads) const = 0;
};

// x [n, d] times the rows of w [E, d], without bias; and its gradients (dw added, dx added or set).
template <typename W>
void RouterScores(std::int64_t n, int d, int experts, const W* x, const W* w, W* scores);
template <typename W>
void RouterScoresBackward(std::int64_t n, int d, int experts, const W* x, const W* w,
                          const W* dscores, bool add, W* dx, W* dw);

// Squared coefficient of variation of v [E] and its gradient (Shazeer et al. 2017, eq. 7).
template <typename W>
W SquaredVariation(const std::vector<W>& v, std::vector<W>& gradient);

// Indices of scores [E] from the highest to the lowest; ties by index.
template <typename W>
void SortScores(int experts, const W* scores, std::vector<int>& order);

// Adds the load of weights and the entropy of shares, both [n, E], each row taken relative to its
// sum; without shares the entropy is that of the weights.
template <typename W>
void AddRouting(std::int64_t n, int experts, const W* weights, const W* shares, RoutingSums& sums);
template <typename W>
void AddRouting(std::int64_t n, int experts, const W* weights, RoutingSums& sums) {
  AddRouting(n, experts, weights, weights, sums);
}

}  // namespace dexremoe
