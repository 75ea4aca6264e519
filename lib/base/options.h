// Command line and configuration files of every tool.
//
// An option is registered once and gives the flag (--sim.substeps=2), the configuration key
// (substeps = 2 under [sim]), the line in --help and the line in the provenance text. The library's
// option structs register themselves under their section:
//
//   struct SimOptions {
//     int substeps = 2;
//     void Register(Options& options) {
//       options.Add("sim.substeps", &substeps, "physics steps per control step").Range(1, 64);
//     }
//   };
//
// A tool's own options have no section in the flag (--out=FILE) and stand under the tool's name in
// a configuration file. Precedence: default < --config files in order < command line.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace dexremoe {

class Options;

// Returned by Options::Add to refine the option just registered.
class OptionHandle {
 public:
  OptionHandle& Required();
  // Closed interval; a value outside is a usage error that names the flag and the interval.
  OptionHandle& Range(double low, double high);
  OptionHandle& Choices(const std::vector<std::string>& allowed);
  // Leaves the option out of the provenance text: it must not change the result (--out, --workers).
  OptionHandle& NotStored();

 private:
  friend class Options;
  OptionHandle(Options* options, CLI::Option* option, std::size_t index)
      : options_(options), option_(option), index_(index) {}
  Options* options_;
  CLI::Option* option_;
  std::size_t index_;
};

class Options {
 public:
  // `example` is one command line that works, shown by --help.
  Options(std::string tool, const std::string& summary, std::string example);
  ~Options();
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

  // Supported types: bool, int, std::int64_t, std::uint64_t, double, std::string and vectors of
  // double, int and std::string (written a,b,c). The value before Parse is the default.
  template <typename T>
  OptionHandle Add(const std::string& name, T* value, const std::string& help);

  // Throws UsageError. Returns false when --help or --version was asked for: the text to print is
  // then in help_text().
  bool Parse(int argc, const char* const* argv);

  const std::string& tool() const { return tool_; }
  const std::string& help_text() const { return help_text_; }
  // "key = value" lines of all stored options, in order of registration.
  std::string Text() const;
  bool Has(const std::string& name) const;

 private:
  friend class OptionHandle;
  struct Entry {
    std::string name;
    std::function<std::string()> print;
    bool stored = true;
  };
  std::vector<std::string> ReadConfig(const std::string& path) const;
  // The option that `key` under [section] sets; throws UsageError with a suggestion.
  std::string FlagOf(const std::string& path, const std::string& section,
                     const std::string& key) const;

  std::string tool_;
  std::string example_;
  std::string help_text_;
  std::vector<std::string> config_files_;
  std::unique_ptr<CLI::App> app_;
  std::vector<Entry> entries_;
};

// The main function of a tool: parses, runs, turns exceptions into one line on stderr and an exit
// code (0 success, 1 failure, 2 usage), and fails when stdout could not be written.
int RunTool(Options& options, int argc, const char* const* argv, const std::function<void()>& body);

}  // namespace dexremoe
