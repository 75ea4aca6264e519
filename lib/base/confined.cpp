#include "base/confined.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>

#include "base/error.h"

namespace dexremoe {
namespace {

constexpr double kGiB = 1024.0 * 1024 * 1024;
constexpr double kClockPerProcessor = 3;  // the machine may be busy
// First byte of what the child sends.
constexpr char kResult = '+', kError = '-';

void Limit(decltype(RLIMIT_AS) resource, double soft, double hard) {
  const rlimit limit = {static_cast<rlim_t>(soft), static_cast<rlim_t>(hard)};
  setrlimit(resource, &limit);
}

// Address space in use, bytes.
double AddressSpace() {
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// What the parent holds open, locks above all, must not outlive it here.
void CloseAllBut(int pipe) {
  const auto keep = static_cast<unsigned>(pipe);
  if (keep > 3) close_range(3, keep - 1, 0);
  close_range(keep + 1, ~0U, 0);
}

void Confine(const ConfinedLimits& limits) {
  for (const int signal : {SIGINT, SIGTERM, SIGALRM, SIGXCPU, SIGPIPE})
    std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {0, 1, 2}) dup2(nowhere, stream);
  const double memory = AddressSpace() + limits.memory * kGiB;
  const double seconds = std::ceil(limits.seconds);
  Limit(RLIMIT_AS, memory, memory);
  Limit(RLIMIT_CPU, seconds, seconds + 1);
  Limit(RLIMIT_CORE, 0, 0);
  Limit(RLIMIT_FSIZE, 0, 0);
  alarm(static_cast<unsigned>(kClockPerProcessor * seconds));
}

std::string Outcome(const std::string& label, const ConfinedLimits& limits,
                    const std::function<std::string()>& work) {
  try {
    return kResult + work();
  } catch (const Error& error) {
    return kError + std::string(error.what());
  } catch (const std::bad_alloc&) {
    return fmt::format("{}{}: needs more than {} GiB of memory", kError, label, limits.memory);
  } catch (const std::exception& error) {
    return fmt::format("{}{}: {}", kError, label, error.what());
  }
}

[[noreturn]] void RunChild(int pipe, const std::string& label, const ConfinedLimits& limits,
                           const std::function<std::string()>& work) {
  CloseAllBut(pipe);
  Confine(limits);
  const std::string outcome = Outcome(label, limits, work);
  for (std::size_t sent = 0; sent < outcome.size();) {
    const ssize_t count = write(pipe, outcome.data() + sent, outcome.size() - sent);
    if (count < 0 && errno != EINTR) break;
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
  _exit(0);  // without the destructors of the parent's objects
}

// All that comes, up to `most` bytes.
std::string ReadAll(int pipe, double most) {
  std::string bytes;
  std::string chunk(1 << 16, '\0');
  while (static_cast<double>(bytes.size()) < most) {
    const ssize_t count = read(pipe, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    bytes.append(chunk, 0, static_cast<std::size_t>(count));
  }
  return bytes;
}

std::string Reason(int status, const ConfinedLimits& limits) {
  if (!WIFSIGNALED(status)) return fmt::format("ended with wait status {}", status);
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU || signal == SIGKILL)
    return fmt::format("took more than {} s of processor time", limits.seconds);
  if (signal == SIGALRM)
    return fmt::format("took more than {} s", kClockPerProcessor * std::ceil(limits.seconds));
  return fmt::format("crashed (signal {}, {})", signal, strsignal(signal));
}

}  // namespace

std::string RunConfined(const std::string& label, const ConfinedLimits& limits,
                        const std::function<std::string()>& work) {
  int ends[2];
  pid_t child;
  {
    // One at a time: another child would keep this pipe's writing end open.
    static std::mutex mutex;
    const std::lock_guard<std::mutex> lock(mutex);
    if (pipe2(ends, O_CLOEXEC) != 0) Fail("{}: cannot make a pipe: {}", label, strerror(errno));
    child = fork();
    if (child == 0) RunChild(ends[1], label, limits, work);
    close(ends[1]);
  }
  const std::string outcome = child > 0 ? ReadAll(ends[0], limits.memory * kGiB) : std::string();
  close(ends[0]);
  if (child < 0) Fail("{}: cannot start a process: {}", label, strerror(errno));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || outcome.empty()) Fail("{}: {}", label, Reason(status, limits));
  if (outcome.front() == kError) Fail("{}", outcome.substr(1));
  return outcome.substr(1);
}

}  // namespace dexremoe
