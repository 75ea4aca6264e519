#include "base/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "base/option_names.h"
#include "base/option_text.h"
#include "base/version.h"

namespace dexremoe {
namespace {

// What a number of type T must look like; "" when `text` does. CLI11 itself takes -1 for an
// unsigned number, and out-of-range ones. A whole number is rewritten, as CLI11 reads 010 as octal.
template <typename T>
std::string NumberFault(std::string& text) {
  T value{};
  const char* end = text.data() + text.size();
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [stop, code] = std::from_chars(begin, end, value);
  if (code == std::errc() && stop == end) {
    if constexpr (std::is_integral_v<T>) text = fmt::format("{}", value);
    return "";
  }
  if constexpr (std::is_floating_point_v<T>)
    return fmt::format("expected a number, found '{}'", text);
  else
    return fmt::format("expected a whole number from {} to {}, found '{}'",
                       std::numeric_limits<T>::min(), std::numeric_limits<T>::max(), text);
}

// Leaves the last of several words for the same option: the command line over the configuration,
// a later file over an earlier one, lists replaced and not grown. All --config words stay.
void KeepLast(std::vector<std::string>& words) {
  const auto name = [](const std::string& word) { return word.substr(0, word.find('=')); };
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool later = std::any_of(words.begin() + static_cast<std::ptrdiff_t>(i) + 1, words.end(),
                                   [&](const auto& word) { return name(word) == name(words[i]); });
    if (!later || name(words[i]) == "--config") kept.push_back(words[i]);
  }
  words = std::move(kept);
}

void CheckRange(const std::string& name, const std::string& text, double low, double high) {
  std::size_t used = 0;
  double value = NAN;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    return;  // not a number: the conversion itself will say so
  }
  if (used != text.size()) return;
  if (!(value >= low && value <= high))
    throw CLI::ValidationError(
        name, fmt::format("expected a value in [{}, {}], found {}", low, high, text));
}

template <typename T>
void AddNumberCheck(CLI::Option* option) {
  if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>)
    option->transform(CLI::Validator([](std::string& text) { return NumberFault<T>(text); }, ""));
}

}  // namespace

OptionHandle& OptionHandle::Required() {
  option_->required();
  return *this;
}

OptionHandle& OptionHandle::Range(double low, double high) {
  const std::string name = options_->entries_[index_].name;
  option_->check(CLI::Validator(
      [name, low, high](const std::string& text) {
        CheckRange("--" + name, text, low, high);
        return std::string();
      },
      fmt::format("in [{}, {}]", low, high)));
  return *this;
}

OptionHandle& OptionHandle::Choices(const std::vector<std::string>& allowed) {
  const std::string list = fmt::format("{}", fmt::join(allowed, ", "));
  option_->check(CLI::Validator(
      [allowed, list](const std::string& text) {
        return Contains(allowed, text) ? std::string()
                                       : fmt::format("expected one of {}, found '{}'", list, text);
      },
      list));
  return *this;
}

OptionHandle& OptionHandle::NotStored() {
  options_->entries_[index_].stored = false;
  return *this;
}

Options::Options(std::string tool, const std::string& summary, std::string example)
    : tool_(std::move(tool)),
      example_(std::move(example)),
      app_(std::make_unique<CLI::App>(summary, tool_)) {
  DEX_CHECK(Contains(kTools, tool_) || tool_.starts_with("test") || tool_.starts_with("bench"));
  app_->set_version_flag("--version", tool_ + " " + kVersion);
  app_->footer("Example:\n  " + example_);
  app_->get_formatter()->column_width(36);
  Add("config", &config_files_, "TOML file(s) with the same names; the command line wins")
      .NotStored();
}

Options::~Options() = default;

template <typename T>
OptionHandle Options::Add(const std::string& name, T* value, const std::string& help) {
  if (const auto dot = name.find('.'); dot != std::string::npos)
    DEX_CHECK(Contains(kSections, name.substr(0, dot)));
  CLI::Option* option = nullptr;
  if constexpr (std::is_same_v<T, bool>) {
    option = app_->add_flag("--" + name + "{true}", *value, help);
    option->default_str(Print(*value));
  } else {
    option = app_->add_option("--" + name, *value, help);
    option->capture_default_str();
  }
  if constexpr (requires { typename T::value_type; } && !std::is_same_v<T, std::string>) {
    option->delimiter(',');
    option->expected(1, CLI::detail::expected_max_vector_size);
    AddNumberCheck<typename T::value_type>(option);
  } else {
    option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    AddNumberCheck<T>(option);
  }
  entries_.push_back({name, [value] { return Print(*value); }});
  return {this, option, entries_.size() - 1};
}

template OptionHandle Options::Add(const std::string&, bool*, const std::string&);
template OptionHandle Options::Add(const std::string&, int*, const std::string&);
template OptionHandle Options::Add(const std::string&, std::int64_t*, const std::string&);
template OptionHandle Options::Add(const std::string&, std::uint64_t*, const std::string&);
template OptionHandle Options::Add(const std::string&, double*, const std::string&);
template OptionHandle Options::Add(const std::string&, std::string*, const std::string&);
template OptionHandle Options::Add(const std::string&, std::vector<double>*, const std::string&);
template OptionHandle Options::Add(const std::string&, std::vector<int>*, const std::string&);
template OptionHandle Options::Add(const std::string&, std::vector<std::string>*,
                                   const std::string&);

bool Options::Has(const std::string& name) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return entry.name == name; });
}

std::string Options::Text() const {
  std::string text;
  for (const Entry& entry : entries_)
    if (entry.stored) text += entry.name + " = " + entry.print() + "\n";
  return text;
}

bool Options::Parse(int argc, const char* const* argv) {
  std::vector<std::string> from_config, from_command_line;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    from_command_line.push_back(word);
    if (!word.starts_with("--config=")) continue;
    for (std::string& flag : ReadConfig(word.substr(9))) from_config.push_back(std::move(flag));
  }
  std::vector<std::string> words(std::move(from_command_line));
  words.insert(words.begin(), from_config.begin(), from_config.end());
  for (const std::string& word : words) {
    if (!word.starts_with("--"))
      throw UsageError(
          fmt::format("unexpected argument '{}'; options are written --name=value", word));
    const std::string name = word.substr(2, word.find('=') - 2);
    if (name == "help" || name == "version" || Has(name)) continue;
    std::vector<std::string> names;
    for (const Entry& entry : entries_) names.push_back(entry.name);
    throw UsageError(fmt::format("unknown option --{}{}", name, Suggestion(name, names)));
  }
  KeepLast(words);
  std::reverse(words.begin(), words.end());  // CLI11 takes the last word first
  try {
    app_->parse(words);
  } catch (const CLI::CallForVersion& version) {
    help_text_ = version.what();
    return false;
  } catch (const CLI::CallForHelp&) {
    help_text_ = app_->help();
    return false;
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return true;
}

int RunTool(Options& options, int argc, const char* const* argv,
            const std::function<void()>& body) {
  int code = 0;
  try {
    if (options.Parse(argc, argv))
      body();
    else
      std::puts(options.help_text().c_str());
  } catch (const UsageError& error) {
    std::fprintf(stderr, "%s: %s\n", options.tool().c_str(), error.what());
    code = 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", options.tool().c_str(), error.what());
    code = 1;
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    std::fprintf(stderr, "%s: stdout could not be written (disk full?)\n", options.tool().c_str());
    code = std::max(code, 1);
  }
  return code;
}

}  // namespace dexremoe
