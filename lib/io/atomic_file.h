// Files that are either whole or absent: written as NAME.tmp, renamed when complete.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace dexremoe {

// Creates the folder that `path` is to stand in, if needed. Throws Error.
void MakeParentFolder(const std::string& path);
// Path under which `path` is written before Commit. Creates the parent folder if needed.
std::string PrepareTemporary(const std::string& path);
// Flushes `temporary` to disk and renames it to `path`. Throws Error.
void CommitTemporary(const std::string& temporary, const std::string& path);

// A text or binary file written in one go. Without Commit nothing is left behind.
class AtomicFile {
 public:
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(std::string_view bytes);
  // Throws Error when anything could not be written (a full disk shows here).
  void Commit();

 private:
  std::string path_, temporary_;
  std::FILE* file_;
};

void WriteFile(const std::string& path, std::string_view bytes);
// Throws Error when the file is missing or unreadable.
std::string ReadFile(const std::string& path);

}  // namespace dexremoe
