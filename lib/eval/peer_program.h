// Starting the programs that benchmarks compare with.
#pragma once

#include <string>

namespace dexremoe {

// `word` as one word of a shell command.
std::string ShellQuoted(const std::string& word);

// The standard output of a shell command that starts `program`. Throws Error naming the program
// when it cannot be started or does not end with 0.
std::string OutputOf(const std::string& program, const std::string& command);

}  // namespace dexremoe
