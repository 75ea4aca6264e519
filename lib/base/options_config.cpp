// Configuration files: TOML sections that become words of the command line.
#include <toml++/toml.h>

#include <algorithm>

#include "base/error.h"
#include "base/option_names.h"
#include "base/option_text.h"
#include "base/options.h"

namespace dexremoe {
namespace {

// A TOML value as it would be written on the command line.
std::string FlagText(const std::string& path, const std::string& key, const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* flag = node.as_boolean()) return Print(flag->get());
  if (const auto* whole = node.as_integer()) return fmt::format("{}", whole->get());
  if (const auto* real = node.as_floating_point()) return fmt::format("{}", real->get());
  if (const auto* list = node.as_array()) {
    std::string text;
    for (const toml::node& item : *list)
      text += (text.empty() ? "" : ",") + FlagText(path, key, item);
    return text;
  }
  throw UsageError(fmt::format(
      "{}: key '{}': expected a number, text, true, false or a list, found another type", path,
      key));
}

}  // namespace

std::string Options::FlagOf(const std::string& path, const std::string& section,
                            const std::string& key) const {
  // [decompose] holds both the tool's own options and the library's section of that name.
  if (section == tool_ && Has(key)) return key;
  if (const std::string name = section + "." + key; Has(name)) return name;
  std::vector<std::string> known;
  for (const Entry& entry : entries_) {
    if (entry.name.starts_with(section + "."))
      known.push_back(entry.name.substr(section.size() + 1));
    else if (section == tool_ && entry.name.find('.') == std::string::npos)
      known.push_back(entry.name);
  }
  throw UsageError(
      fmt::format("{}: unknown key '{}' in [{}]{}", path, key, section, Suggestion(key, known)));
}

std::vector<std::string> Options::ReadConfig(const std::string& path) const {
  toml::table table;
  try {
    table = toml::parse_file(path);
  } catch (const toml::parse_error& error) {
    throw UsageError(fmt::format("{}: line {}: {}", path, error.source().begin.line,
                                 std::string(error.description())));
  }
  std::vector<std::string> flags;
  for (const auto& [section_key, node] : table) {
    const std::string section(section_key.str());
    const toml::table* keys = node.as_table();
    if (keys == nullptr)
      throw UsageError(fmt::format("{}: key '{}' stands outside any [section]", path, section));
    if (!Contains(kSections, section) && !Contains(kTools, section) && section != tool_) {
      std::vector<std::string> names(kSections.begin(), kSections.end());
      names.insert(names.end(), kTools.begin(), kTools.end());
      throw UsageError(
          fmt::format("{}: unknown section [{}]{}", path, section, Suggestion(section, names)));
    }
    const bool used =
        section == tool_ || std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
          return entry.name.starts_with(section + ".");
        });
    if (!used) continue;
    for (const auto& [key, value] : *keys) {
      const std::string name(key.str());
      flags.push_back(
          fmt::format("--{}={}", FlagOf(path, section, name), FlagText(path, name, value)));
    }
  }
  return flags;
}

}  // namespace dexremoe
