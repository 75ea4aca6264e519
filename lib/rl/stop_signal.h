// Ctrl-C and kill end a training after the iteration at hand, with its checkpoint written.
#pragma once

#include <atomic>

namespace dexremoe {

// Installs handlers for SIGINT and SIGTERM and returns the flag they set. Called by tools only; a
// second signal ends the process at once.
const std::atomic<bool>& CatchStopSignals();

}  // namespace dexremoe
