#include "base/check.h"

#include <cstdio>
#include <cstdlib>

namespace dexremoe::internal {

void CheckFailed(const char* file, int line, const char* what, const std::string& values) {
  std::fprintf(stderr, "%s:%d: check failed: %s%s%s\n", file, line, what,
               values.empty() ? "" : ": ", values.c_str());
  std::abort();
}

}  // namespace dexremoe::internal
