#include "io/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "base/error.h"
#include "io/h5.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// A fresh folder, removed at the end.
class Folder {
 public:
  Folder() : path_(fs::path(::testing::TempDir()) / ("dex_io_" + std::to_string(getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  int files() const {
    int n = 0;
    for (const auto& entry : fs::recursive_directory_iterator(path_)) n += entry.is_regular_file();
    return n;
  }

 private:
  fs::path path_;
};

// Files may not grow beyond `bytes` while this lives: writing fails as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit old_{};
  void (*handler_)(int);
};

TEST(AtomicFile, AppearsOnlyAtCommit) {
  Folder folder;
  const std::string path = folder / "sub/deep/a.txt";
  {
    AtomicFile file(path);
    file.Write("hello");
    EXPECT_FALSE(fs::exists(path));
    file.Commit();
  }
  EXPECT_EQ(ReadFile(path), "hello");
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, WithoutCommitTheOldFileStaysAndNothingIsLeft) {
  Folder folder;
  const std::string path = folder / "a.txt";
  WriteFile(path, "old");
  {
    AtomicFile file(path);
    file.Write("new");
  }
  EXPECT_EQ(ReadFile(path), "old");
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, AFullDiskIsAnErrorAndKeepsTheOldFile) {
  Folder folder;
  const std::string path = folder / "a.txt";
  WriteFile(path, "old");
  std::string message;
  {
    FullDisk full(4096);
    try {
      WriteFile(path, std::string(1 << 20, 'x'));
    } catch (const Error& error) {
      message = error.what();
    }
  }
  EXPECT_THAT(message, HasSubstr("a.txt: cannot be written"));
  EXPECT_EQ(ReadFile(path), "old");
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, APlaceThatCannotBeWrittenIsNamed) {
  Folder folder;
  WriteFile(folder / "file", "x");
  try {
    WriteFile(folder / "file/below.txt", "x");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("file"));
  }
  // A folder stands where the file should go: the temporary does not stay either.
  fs::create_directories(folder / "taken/inside");
  EXPECT_THROW(WriteFile(folder / "taken", "x"), Error);
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, AMissingFileIsNamed) {
  try {
    ReadFile("/nowhere/a.txt");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nowhere/a.txt: cannot be read: No such file"));
  }
  EXPECT_THROW(ReadFile("."), Error);  // a folder
}

TEST(H5Writer, AFullDiskIsAnErrorAndKeepsTheOldFile) {
  Folder folder;
  const std::string path = folder / "a.h5";
  constexpr H5Format kFormat{"dexremoe.test", 1};
  const H5Doc doc{"1", "row", "numbers"};
  {
    H5Writer file(path, kFormat, {"test", "", 1, {}});
    file.WriteScalar("x", 1.0, doc);
    file.Commit();
  }
  for (const std::size_t count : {std::size_t{600}, std::size_t{1} << 18}) {
    std::string message;
    {
      FullDisk full(4096);
      try {
        H5Writer file(path, kFormat, {"test", std::string(3000, 'o'), 2, {}});
        file.Write("x", std::vector<double>(count, 1), {static_cast<std::int64_t>(count)}, doc);
        file.Commit();
      } catch (const Error& error) {
        message = error.what();
      }
    }
    EXPECT_THAT(message, HasSubstr("a.h5")) << count;
    EXPECT_EQ(H5Reader(path, kFormat).ReadScalar<double>("x"), 1.0);
    EXPECT_EQ(folder.files(), 1);
  }
  // The library still works afterwards.
  H5Writer file(folder / "b.h5", kFormat, {"test", "", 1, {}});
  file.WriteScalar("x", 2.0, doc);
  EXPECT_NO_THROW(file.Commit());
}

}  // namespace
}  // namespace dexremoe
