// How options are written: values as text, and the name that was meant by a misspelt one.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

namespace dexremoe {

// "; did you mean 'NAME'?" for the nearest of `names`, or "" where none is near.
std::string Suggestion(std::string_view word, const std::vector<std::string>& names);

// How a value stands in the provenance text and in a configuration file.
inline std::string Print(bool value) { return value ? "true" : "false"; }
inline std::string Print(const std::string& value) { return '"' + value + '"'; }
template <typename T>
std::string Print(T value) {
  return fmt::format("{}", value);
}
template <typename T>
std::string Print(const std::vector<T>& values) {
  std::string text;
  for (const T& value : values) text += (text.empty() ? "" : ", ") + Print(value);
  return '[' + text + ']';
}

}  // namespace dexremoe
