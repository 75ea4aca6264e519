// MP4 files through the ffmpeg program.
#pragma once

#include <cstdio>
#include <string>

#include "io/png.h"

namespace dexremoe {

// H.264 in MP4, frames of one size at a fixed rate. Without Finish nothing is left behind.
class VideoWriter {
 public:
  // Width and height must be even (4:2:0 colour). Throws Error when ffmpeg cannot be started.
  VideoWriter(std::string path, int width, int height, double frames_per_second);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  // Throws Error with ffmpeg's last words when it has given up.
  void Add(const Image& frame);
  // Waits for ffmpeg and puts the file in its place. Throws Error as Add.
  void Finish();

 private:
  void Start(double frames_per_second);
  // Closes the pipe and waits; true when ffmpeg was content.
  bool Wait();
  [[noreturn]] void FailWithLog();

  std::string path_, temporary_;
  int width_, height_;
  std::FILE* log_ = nullptr;  // what ffmpeg says, unlinked
  int socket_ = -1;
  int process_ = -1;
};

}  // namespace dexremoe
