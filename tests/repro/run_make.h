// make, run from the project's top folder.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace dexremoe {

struct Outcome {
  int code = -1;
  std::string text;  // stdout and stderr
};

// Without the variables of a make that runs the tests.
inline Outcome Make(const std::string& words) {
  const std::string line = "env -u MAKEFLAGS -u MFLAGS -u MAKELEVEL make " + words + " 2>&1";
  std::FILE* pipe = popen(line.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.text += buffer.data();
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

}  // namespace dexremoe
