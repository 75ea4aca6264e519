// A file that one process at a time may write.
#pragma once

#include <string>

namespace dexremoe {

// Held from construction to destruction, or to the end of the process, however it ends. PATH.lock
// stands beside the file meanwhile.
class FileLock {
 public:
  // Throws Error naming `path` when another process holds it.
  explicit FileLock(const std::string& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::string path_;
  int descriptor_;
};

}  // namespace dexremoe
