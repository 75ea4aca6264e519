#include "render/video.h"

#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "base/check.h"
#include "base/error.h"
#include "io/atomic_file.h"

extern char** environ;

namespace dexremoe {

VideoWriter::VideoWriter(std::string path, int width, int height, double frames_per_second)
    : path_(std::move(path)), width_(width), height_(height) {
  if (width % 2 != 0 || height % 2 != 0)
    Fail("{}: a video needs an even width and height, found {} x {}", path_, width, height);
  temporary_ = PrepareTemporary(path_);
  log_ = std::tmpfile();
  if (log_ == nullptr) Fail("{}: no temporary file: {}", path_, std::strerror(errno));
  try {
    Start(frames_per_second);
  } catch (...) {
    std::fclose(log_);
    throw;
  }
}

// Bit-exact, one thread: equal frames give equal files. Frames go through a socket, not a pipe, so
// that writing to a dead ffmpeg is an error and not a signal.
void VideoWriter::Start(double frames_per_second) {
  const std::string size = fmt::format("{}x{}", width_, height_);
  const std::string rate = fmt::format("{}", frames_per_second);
  std::vector<std::string> words = {"ffmpeg",
                                    "-nostdin",
                                    "-loglevel",
                                    "error",
                                    "-y",
                                    "-f",
                                    "rawvideo",
                                    "-pix_fmt",
                                    "rgb24",
                                    "-s",
                                    size,
                                    "-r",
                                    rate,
                                    "-i",
                                    "pipe:0",
                                    "-an",
                                    "-c:v",
                                    "libx264",
                                    "-preset",
                                    "medium",
                                    "-crf",
                                    "18",
                                    "-pix_fmt",
                                    "yuv420p",
                                    "-threads",
                                    "1",
                                    "-fflags",
                                    "+bitexact",
                                    "-flags:v",
                                    "+bitexact",
                                    "-map_metadata",
                                    "-1",
                                    "-movflags",
                                    "+faststart",
                                    "-f",
                                    "mp4",
                                    "file:" + temporary_};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    Fail("{}: no socket: {}", path_, std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 0);
  posix_spawn_file_actions_adddup2(&actions, fileno(log_), 1);
  posix_spawn_file_actions_adddup2(&actions, fileno(log_), 2);
  pid_t process = -1;
  const int error = posix_spawnp(&process, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error != 0) {
    close(ends[0]);
    Fail("{}: ffmpeg cannot be started: {} (Debian package ffmpeg)", path_, std::strerror(error));
  }
  socket_ = ends[0];
  process_ = process;
}

VideoWriter::~VideoWriter() {
  Wait();
  std::fclose(log_);
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void VideoWriter::Add(const Image& frame) {
  DEX_CHECK_EQ(frame.width, width_);
  DEX_CHECK_EQ(frame.height, height_);
  const std::uint8_t* from = frame.rgb.data();
  std::size_t left = frame.rgb.size();
  while (left > 0) {
    const ssize_t sent = send(socket_, from, left, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) FailWithLog();
    from += sent;
    left -= std::size_t(sent);
  }
}

void VideoWriter::Finish() {
  if (!Wait()) FailWithLog();
  CommitTemporary(temporary_, path_);
}

bool VideoWriter::Wait() {
  if (process_ < 0) return false;
  close(socket_);
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void VideoWriter::FailWithLog() {
  Wait();
  std::rewind(log_);
  std::string last;
  char line[512];
  while (std::fgets(line, sizeof line, log_) != nullptr)
    if (line[0] != '\n') last = line;
  while (!last.empty() && last.back() == '\n') last.pop_back();
  Fail("{}: ffmpeg failed: {}", path_, last.empty() ? "without a word" : last);
}

}  // namespace dexremoe
