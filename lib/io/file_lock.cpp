#include "io/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

// Whether the open file is still the one of that name: its last owner may have removed it.
bool IsStill(int descriptor, const std::string& path) {
  struct stat open_file {
  }, named_file{};
  return fstat(descriptor, &open_file) == 0 && stat(path.c_str(), &named_file) == 0 &&
         open_file.st_ino == named_file.st_ino && open_file.st_dev == named_file.st_dev;
}

}  // namespace

FileLock::FileLock(const std::string& path) : path_(path + ".lock") {
  MakeParentFolder(path_);
  for (;;) {
    descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) Fail("{}: cannot be created: {}", path_, std::strerror(errno));
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      close(descriptor_);
      if (error == EWOULDBLOCK) Fail("{}: another process is writing it", path);
      Fail("{}: cannot be locked: {}", path_, std::strerror(error));
    }
    if (IsStill(descriptor_, path_)) return;
    close(descriptor_);
  }
}

FileLock::~FileLock() {
  unlink(path_.c_str());
  close(descriptor_);
}

}  // namespace dexremoe
