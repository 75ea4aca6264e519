#include "nn/one_thread.h"

#include <dlfcn.h>

namespace dexremoe {

// The function is looked up at run time because the build does not link libgomp itself; oneDNN
// brings it in.
void KeepToOneThread() {
  thread_local const bool done = [] {
    using SetNumThreads = void (*)(int);
    const auto set = reinterpret_cast<SetNumThreads>(dlsym(RTLD_DEFAULT, "omp_set_num_threads"));
    if (set != nullptr) set(1);
    return true;
  }();
  (void)done;
}

}  // namespace dexremoe
