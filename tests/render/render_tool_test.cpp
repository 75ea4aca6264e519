// The render program from outside: exit codes and messages for wrong input.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

#include "io/atomic_file.h"
#include "io/h5.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

class RenderTool : public testing::Test {
 protected:
  void SetUp() override {
    program_ = fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "bin" / "render";
    if (!fs::exists(program_)) GTEST_SKIP() << program_ << " is not built";
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Runs it without a display and returns the exit code; stderr is in message_.
  int Run(const std::string& arguments) {
    const std::string errors = folder_ + "/stderr.txt";
    const std::string command = "env -u DISPLAY -u WAYLAND_DISPLAY '" + program_.string() + "' " +
                                arguments + " >/dev/null 2>'" + errors + "'";
    const int status = std::system(command.c_str());
    message_ = ReadFile(errors);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  bool Says(const std::string& words) const { return message_.find(words) != std::string::npos; }

  fs::path program_;
  std::string folder_ = testing::TempDir() + "/dexremoe_render_tool";
  std::string out_ = folder_ + "/out.png";
  std::string message_;
};

TEST_F(RenderTool, UnknownKindsAndFlagsAreUsageErrors) {
  EXPECT_EQ(Run("--kind=dream --out=" + out_), 2) << message_;
  EXPECT_EQ(Run("--kind=hand --heigth=480 --out=" + out_), 2) << message_;
  EXPECT_EQ(Run("--kind=strip --out=" + out_), 2) << message_;
  EXPECT_TRUE(Says("--trace")) << message_;
  EXPECT_EQ(Run("--kind=objects --out=" + out_), 2) << message_;
  EXPECT_TRUE(Says("--objects")) << message_;
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(RenderTool, AMissingTraceIsNamed) {
  EXPECT_EQ(Run("--kind=strip --trace=/no/trace.h5 --objects=/no/objects.csv --out=" + out_), 1);
  EXPECT_TRUE(Says("/no/trace.h5")) << message_;
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(RenderTool, AFileOfAnotherFormatIsRefused) {
  const std::string path = folder_ + "/mesh.h5";
  H5Writer writer(path, {"dexremoe.mesh", 1}, Provenance{"test", "", 0, {}});
  writer.WriteScalar("mass", 1.0, {"kg", "", "mass"});
  writer.Commit();
  EXPECT_EQ(Run("--kind=video --trace=" + path + " --objects=x.csv --out=" + out_), 1);
  EXPECT_TRUE(Says("dexremoe.trace")) << message_;
  EXPECT_TRUE(Says("dexremoe.mesh")) << message_;
}

TEST_F(RenderTool, AMissingHandIsNamedAndTheOldPictureStays) {
  WriteFile(out_, "old");
  EXPECT_EQ(Run("--kind=hand --hand=/no/hand.urdf --out=" + out_), 1);
  EXPECT_TRUE(Says("/no/hand.urdf")) << message_;
  EXPECT_EQ(ReadFile(out_), "old");
}

TEST_F(RenderTool, TwoRunsGiveEqualPictures) {
  if (!fs::exists("data/hand/gx11.urdf")) GTEST_SKIP() << "not run from the project's folder";
  ASSERT_EQ(Run("--kind=hand --width=160 --height=120 --out=" + out_), 0) << message_;
  const std::string first = ReadFile(out_);
  ASSERT_EQ(Run("--kind=hand --width=160 --height=120 --out=" + out_), 0) << message_;
  EXPECT_EQ(ReadFile(out_), first);
}

}  // namespace
}  // namespace dexremoe
