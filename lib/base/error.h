// Errors that a user can cause (bad files, bad options): thrown as Error, printed by the tool.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace dexremoe {

// Bad input. The message names the file, the field, what was expected and what was found.
// A tool prints it on one line and exits with 1.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A wrong command line or configuration key; a tool exits with 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

// Throws Error with a formatted message: Fail("{}: expected {} columns, found {}", path, 3, n).
template <typename... Args>
[[noreturn]] void Fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace dexremoe
