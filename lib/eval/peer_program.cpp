#include "eval/peer_program.h"

#include <sys/wait.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.h"

namespace dexremoe {

std::string ShellQuoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string OutputOf(const std::string& program, const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "re");
  if (pipe == nullptr) Fail("{}: cannot be started: {}", program, std::strerror(errno));
  std::string text;
  char chunk[256];
  while (const std::size_t got = std::fread(chunk, 1, sizeof chunk, pipe)) text.append(chunk, got);
  const int status = pclose(pipe);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    Fail("{}: expected success, found wait status {}", program, status);
  return text;
}

}  // namespace dexremoe
