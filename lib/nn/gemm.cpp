#include <dnnl.h>

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "base/check.h"
#include "nn/layers.h"
#include "nn/one_thread.h"

namespace dexremoe {
namespace {

// For fewer rows sgemm takes other ways and rounds otherwise. Filled up to this many, what comes
// out for a row does not depend on how many others come with it.
constexpr std::int64_t kFewRows = 64;

void Sgemm(bool transpose_a, bool transpose_b, std::int64_t m, std::int64_t n, std::int64_t k,
           float alpha, const float* a, std::int64_t lda, const float* b, std::int64_t ldb,
           float beta, float* c, std::int64_t ldc) {
  KeepToOneThread();
  const dnnl_status_t status = dnnl_sgemm(transpose_a ? 'T' : 'N', transpose_b ? 'T' : 'N', m, n, k,
                                          alpha, a, lda, b, ldb, beta, c, ldc);
  DEX_CHECK_EQ(static_cast<int>(status), static_cast<int>(dnnl_success));
}

}  // namespace

template <>
void Gemm<float>(bool transpose_a, bool transpose_b, std::int64_t m, std::int64_t n, std::int64_t k,
                 float alpha, const float* a, std::int64_t lda, const float* b, std::int64_t ldb,
                 float beta, float* c, std::int64_t ldc) {
  if (transpose_a || m >= kFewRows)
    return Sgemm(transpose_a, transpose_b, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc);
  thread_local std::vector<float> rows, out;
  rows.assign(kFewRows * k, 0.0f);
  out.assign(kFewRows * n, 0.0f);
  for (std::int64_t i = 0; i < m; ++i) {
    std::copy_n(a + i * lda, k, rows.begin() + i * k);
    if (beta != 0) std::copy_n(c + i * ldc, n, out.begin() + i * n);
  }
  Sgemm(false, transpose_b, kFewRows, n, k, alpha, rows.data(), k, b, ldb, beta, out.data(), n);
  for (std::int64_t i = 0; i < m; ++i) std::copy_n(out.begin() + i * n, n, c + i * ldc);
}

// Only gradient checks run in double, so clarity comes before speed.
template <>
void Gemm<double>(bool transpose_a, bool transpose_b, std::int64_t m, std::int64_t n,
                  std::int64_t k, double alpha, const double* a, std::int64_t lda, const double* b,
                  std::int64_t ldb, double beta, double* c, std::int64_t ldc) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Stride = Eigen::OuterStride<>;
  using Input = Eigen::Map<const Matrix, Eigen::Unaligned, Stride>;
  const Input left(a, transpose_a ? k : m, transpose_a ? m : k, Stride(lda));
  const Input right(b, transpose_b ? n : k, transpose_b ? k : n, Stride(ldb));
  Eigen::Map<Matrix, Eigen::Unaligned, Stride> result(c, m, n, Stride(ldc));
  Matrix product(m, n);
  if (transpose_a && transpose_b)
    product = left.transpose() * right.transpose();
  else if (transpose_a)
    product = left.transpose() * right;
  else if (transpose_b)
    product = left * right.transpose();
  else
    product = left * right;
  // As in BLAS, beta = 0 ignores what c held (it may be uninitialised).
  if (beta == 0)
    result = alpha * product;
  else
    result = alpha * product + beta * result;
}

}  // namespace dexremoe
