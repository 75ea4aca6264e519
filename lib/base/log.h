// Talk to the person at the terminal: log lines and a progress bar, both on stderr.
// Results go to stdout and are printed by tools only.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

namespace dexremoe {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

void SetLogLevel(LogLevel level);
void Log(LogLevel level, std::string_view message);

template <typename... Args>
void LogInfo(fmt::format_string<Args...> format, Args&&... args) {
  Log(LogLevel::kInfo, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void LogWarning(fmt::format_string<Args...> format, Args&&... args) {
  Log(LogLevel::kWarning, fmt::format(format, std::forward<Args>(args)...));
}

// A bar with the fraction done, the time left and a free-form note, redrawn in place. It draws
// only when stderr is a terminal; elsewhere it prints a plain line at most every `quiet_seconds`.
class Progress {
 public:
  Progress(std::string label, double total, double quiet_seconds = 30);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` runs from 0 to total; `start` of a resumed run is set by the first call.
  void Update(double done, std::string_view note = {});
  void Finish();

 private:
  using Clock = std::chrono::steady_clock;
  void Draw(double done, std::string_view note, Clock::time_point now);

  std::string label_;
  double total_;
  double quiet_seconds_;
  bool terminal_;
  bool started_ = false;
  bool open_line_ = false;
  double first_done_ = 0;
  Clock::time_point start_, last_;
};

// "1 h 02 min", "3 min 20 s", "4.2 s".
std::string FormatDuration(double seconds);

}  // namespace dexremoe
