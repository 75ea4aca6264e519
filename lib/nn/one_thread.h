// oneDNN on the calling thread alone.
#pragma once

namespace dexremoe {

// Debian's oneDNN splits every product over an OpenMP team. Our callers already run on every core
// through ThreadPool, so each calling thread tells OpenMP once to keep to itself: the team size is
// a setting of the calling thread, not of the process. To be called before oneDNN is.
void KeepToOneThread();

}  // namespace dexremoe
