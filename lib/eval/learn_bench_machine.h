// What learning costs and what the machine gives: operations, peak rate, memory.
#pragma once

#include <string>

#include "base/thread_pool.h"
#include "nn/params.h"

namespace dexremoe {

// Floating-point operations of a forward pass of one row: two per weight that a row meets. The
// weights of mu_pc ("encoder/cloud/") are met once per object and not counted. An update costs
// three times as many per row and mini-epoch: forward, gradients of inputs, gradients of weights.
double ForwardOperations(const ParamLayout& layout);

// Starts a new measurement of PeakMemory, with unused memory given back. Where the system cannot
// do so, the peak stays the one since the program's start.
void ResetPeakMemory();
// The most memory that this process had resident since ResetPeakMemory, GiB.
double PeakMemory();

// Time spent, s: by the clock, and processor time of all threads of this process.
struct Cost {
  double wall = 0, cpu = 0;
  Cost& operator+=(const Cost& other);
};

// Starts when it is made.
class Stopwatch {
 public:
  Stopwatch();
  Cost Read() const;  // since the start

 private:
  Cost start_;
};

// What one operation of products of 1024 x 1024 matrices (oneDNN) takes in `precision` (f32 or
// bf16), one product at a time on every thread of the pool, over at least `seconds`.
Cost ProductCost(ThreadPool& pool, const std::string& precision, double seconds);

}  // namespace dexremoe
