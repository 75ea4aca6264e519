#include "io/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/error.h"

namespace dexremoe {

void MakeParentFolder(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  std::error_code code;
  if (!parent.empty()) std::filesystem::create_directories(parent, code);
  if (code) Fail("{}: cannot create the folder: {}", parent.string(), code.message());
}

std::string PrepareTemporary(const std::string& path) {
  MakeParentFolder(path);
  return path + ".tmp";
}

void CommitTemporary(const std::string& temporary, const std::string& path) {
  const int descriptor = open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  std::error_code code, ignored;
  if (synced) std::filesystem::rename(temporary, path, code);
  if (!synced || code) std::filesystem::remove(temporary, ignored);
  if (!synced) Fail("{}: cannot be written: {}", path, std::strerror(error));
  if (code) Fail("{}: cannot be renamed into place: {}", path, code.message());
}

AtomicFile::AtomicFile(std::string path)
    : path_(std::move(path)), temporary_(PrepareTemporary(path_)) {
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr) Fail("{}: cannot be created: {}", path_, std::strerror(errno));
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::Write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
    Fail("{}: cannot be written: {}", path_, std::strerror(errno));
}

void AtomicFile::Commit() {
  if (std::fflush(file_) != 0) Fail("{}: cannot be written: {}", path_, std::strerror(errno));
  const int closed = std::fclose(file_);
  file_ = nullptr;
  if (closed != 0) {
    const int error = errno;
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    Fail("{}: cannot be written: {}", path_, std::strerror(error));
  }
  CommitTemporary(temporary_, path_);
}

void WriteFile(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.Write(bytes);
  file.Commit();
}

std::string ReadFile(const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) Fail("{}: cannot be read: {}", path, std::strerror(errno));
  std::string bytes;
  char buffer[1 << 16];
  std::size_t got = 0;
  while ((got = std::fread(buffer, 1, sizeof buffer, file)) > 0) bytes.append(buffer, got);
  const bool failed = std::ferror(file) != 0;
  std::fclose(file);
  if (failed) Fail("{}: cannot be read: {}", path, std::strerror(EIO));
  return bytes;
}

}  // namespace dexremoe
