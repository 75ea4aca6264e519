// Work on input from strangers in a child process: a crash, a hang or a hunger for memory in a
// library that reads it ends in a message.
#pragma once

#include <functional>
#include <string>

namespace dexremoe {

struct ConfinedLimits {
  double seconds = 20;  // of processor time; three times as long by the clock
  double memory = 2;    // GiB, on top of what this process has
};

// What `work` returns. It runs in a fork of this process, so nothing that it changes stays; it
// prints nothing and writes no files. Throws Error: with the message of an Error that `work`
// throws, or "LABEL: " and what stopped it.
std::string RunConfined(const std::string& label, const ConfinedLimits& limits,
                        const std::function<std::string()>& work);

}  // namespace dexremoe
