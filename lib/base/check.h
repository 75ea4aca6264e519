// Checks for bugs. They stay on in release builds and abort with both values printed.
// Bad input is not a bug: use Fail() from base/error.h for that.
#pragma once

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ostr.h>

#include <string>

namespace dexremoe::internal {

[[noreturn]] void CheckFailed(const char* file, int line, const char* what,
                              const std::string& values);

}  // namespace dexremoe::internal

#define DEX_CHECK(condition)                                                            \
  do {                                                                                  \
    if (!(condition)) [[unlikely]]                                                      \
      ::dexremoe::internal::CheckFailed(__FILE__, __LINE__, #condition, std::string()); \
  } while (false)

#define DEX_CHECK_OP(a, op, b)                                                              \
  do {                                                                                      \
    const auto& dex_a_ = (a);                                                               \
    const auto& dex_b_ = (b);                                                               \
    if (!(dex_a_ op dex_b_)) [[unlikely]]                                                   \
      ::dexremoe::internal::CheckFailed(__FILE__, __LINE__, #a " " #op " " #b,              \
                                        fmt::format("{} against {}", dex_a_, dex_b_));      \
  } while (false)

#define DEX_CHECK_EQ(a, b) DEX_CHECK_OP(a, ==, b)
#define DEX_CHECK_NE(a, b) DEX_CHECK_OP(a, !=, b)
#define DEX_CHECK_LT(a, b) DEX_CHECK_OP(a, <, b)
#define DEX_CHECK_LE(a, b) DEX_CHECK_OP(a, <=, b)
#define DEX_CHECK_GT(a, b) DEX_CHECK_OP(a, >, b)
#define DEX_CHECK_GE(a, b) DEX_CHECK_OP(a, >=, b)
