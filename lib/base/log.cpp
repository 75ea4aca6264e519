#include "base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace dexremoe {
namespace {

spdlog::logger& Logger() {
  static const std::shared_ptr<spdlog::logger> logger = [] {
    auto result = std::make_shared<spdlog::logger>(
        "dexremoe", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    result->set_pattern("%^%l%$: %v");
    return result;
  }();
  return *logger;
}

spdlog::level::level_enum SpdlogLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

}  // namespace

void SetLogLevel(LogLevel level) { Logger().set_level(SpdlogLevel(level)); }

void Log(LogLevel level, std::string_view message) {
  Logger().log(SpdlogLevel(level), "{}", message);
}

std::string FormatDuration(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0) return "?";
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

Progress::Progress(std::string label, double total, double quiet_seconds)
    : label_(std::move(label)),
      total_(total),
      quiet_seconds_(quiet_seconds),
      terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() { Finish(); }

void Progress::Update(double done, std::string_view note) {
  const auto now = Clock::now();
  if (!started_) {
    started_ = true;
    first_done_ = done;
    start_ = last_ = now;
    if (terminal_) Draw(done, note, now);
    return;
  }
  const double since = std::chrono::duration<double>(now - last_).count();
  if (since < (terminal_ ? 0.1 : quiet_seconds_) && done < total_) return;
  last_ = now;
  Draw(done, note, now);
}

void Progress::Draw(double done, std::string_view note, Clock::time_point now) {
  const double fraction = total_ > 0 ? std::clamp(done / total_, 0.0, 1.0) : 1.0;
  const double spent = std::chrono::duration<double>(now - start_).count();
  const double left = done > first_done_ ? spent * (total_ - done) / (done - first_done_) : NAN;
  const std::string tail = fmt::format("{:3.0f} %  {} left{}{}", 100 * fraction,
                                       FormatDuration(left), note.empty() ? "" : "  ", note);
  if (!terminal_) {
    LogInfo("{}: {}", label_, tail);
    return;
  }
  constexpr int kWidth = 24;
  const int filled = static_cast<int>(std::lround(kWidth * fraction));
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "\r%s [%s] %s\033[K", label_.c_str(), bar.c_str(), tail.c_str());
  std::fflush(stderr);
  open_line_ = true;
}

void Progress::Finish() {
  if (open_line_) std::fputc('\n', stderr);
  open_line_ = false;
}

}  // namespace dexremoe
