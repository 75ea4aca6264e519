// How every tool behaves on a command line: help, exit codes, messages, files left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string BinFolder() {
  const char* folder = std::getenv("DEX_BIN");
  return folder != nullptr ? folder : "build/bin";
}

struct Outcome {
  int code = -1;
  std::string text;  // stdout and stderr
  int lines() const { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }
};

// Runs a shell line; redirections inside it win over the capture.
Outcome Shell(const std::string& line) {
  std::FILE* pipe = popen(("{ " + line + "; } 2>&1").c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.text += buffer.data();
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

Outcome Tool(const std::string& words) { return Shell(BinFolder() + "/" + words); }

std::vector<std::string> Tools() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator("tools"))
    if (entry.path().extension() == ".cpp") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

std::string Slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

class Manners : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("dexremoe_manners_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Put(const std::string& name, const std::string& bytes) const {
    std::ofstream(Path(name), std::ios::binary) << bytes;
    return Path(name);
  }
  // A closed box as OBJ.
  std::string Box() const {
    return Put("box.obj",
               "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 0 1 1\n"
               "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  }
  fs::path folder_;
};

class EveryTool : public testing::TestWithParam<std::string> {};

TEST_P(EveryTool, HelpSucceedsAndShowsAnExample) {
  const Outcome outcome = Tool(GetParam() + " --help");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.text, HasSubstr("Example:\n  " + GetParam()));
}

TEST_P(EveryTool, VersionSucceeds) { EXPECT_EQ(Tool(GetParam() + " --version").code, 0); }

TEST_P(EveryTool, AnUnknownFlagExitsWith2AndIsNamed) {
  const Outcome outcome = Tool(GetParam() + " --no_such_flag=1");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("no_such_flag"));
  EXPECT_EQ(outcome.lines(), 1) << outcome.text;
}

TEST_P(EveryTool, AStrayWordExitsWith2) {
  const Outcome outcome = Tool(GetParam() + " stray");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("stray"));
}

TEST_P(EveryTool, AFullStdoutIsAFailure) {
  EXPECT_NE(Shell(BinFolder() + "/" + GetParam() + " --help >/dev/full").code, 0);
}

INSTANTIATE_TEST_SUITE_P(Manners, EveryTool, testing::ValuesIn(Tools()),
                         [](const auto& info) { return info.param; });

TEST_F(Manners, TrailingCharactersInANumberExitWith2) {
  const Outcome outcome =
      Tool("scale_mesh --mesh=" + Box() + " --out=" + Path("m.h5") + " --scale.scale=0.8x");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("0.8x"));
  EXPECT_FALSE(fs::exists(Path("m.h5")));
}

TEST_F(Manners, AMissingInputIsOneLineThatNamesIt) {
  const Outcome outcome = Tool("scale_mesh --mesh=" + Path("absent.ply") + " --out=" + Path("m.h5"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("absent.ply"));
  EXPECT_EQ(outcome.lines(), 1) << outcome.text;
}

TEST_F(Manners, ABadInputLeavesTheExistingOutputUntouched) {
  const std::string out = Put("m.h5", "precious");
  const std::string empty = Put("empty.stl", "");
  EXPECT_EQ(Tool("scale_mesh --mesh=" + empty + " --out=" + out).code, 1);
  EXPECT_EQ(Slurp(out), "precious");
}

TEST_F(Manners, AMisspeltConfigurationKeyIsNamedWithASuggestion) {
  const std::string config = Put("c.toml", "[scale]\nlenght = 0.1\n");
  const Outcome outcome =
      Tool("scale_mesh --mesh=" + Box() + " --out=" + Path("m.h5") + " --config=" + config);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, HasSubstr("lenght"));
  EXPECT_THAT(outcome.text, HasSubstr("'length'"));
  EXPECT_THAT(outcome.text, HasSubstr("c.toml"));
}

TEST_F(Manners, AFullDiskFailsAndLeavesNothingBehind) {
  const Outcome outcome =
      Shell("trap '' XFSZ; ulimit -f 1; " + BinFolder() + "/scale_mesh --mesh=" + Box() +
            " --out=" + Path("m.h5") + " >/dev/null");
  EXPECT_EQ(outcome.code, 1) << outcome.text;
  EXPECT_FALSE(fs::exists(Path("m.h5")));
  EXPECT_FALSE(fs::exists(Path("m.h5.tmp")));
}

TEST_F(Manners, TheSameCommandTwiceGivesTheSameBytes) {
  const std::string words = "scale_mesh --mesh=" + Box() + " --category=vehicle --out=";
  ASSERT_EQ(Tool(words + Path("a.h5")).code, 0);
  ASSERT_EQ(Tool(words + Path("b.h5")).code, 0);
  EXPECT_EQ(Slurp(Path("a.h5")), Slurp(Path("b.h5")));
  EXPECT_EQ(Tool("h5_diff --a=" + Path("a.h5") + " --b=" + Path("b.h5")).text, "");
}

TEST_F(Manners, AFileOfAnotherFormatIsRefusedByName) {
  ASSERT_EQ(Tool("scale_mesh --mesh=" + Box() + " --category=vehicle --out=" + Path("m.h5")).code, 0);
  const Outcome outcome =
      Tool("describe_shape --net=" + Path("m.h5") + " --cloud=" + Path("m.h5") + " --out=" + Path("s.h5"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("dexremoe.mesh"));
  EXPECT_EQ(outcome.lines(), 1) << outcome.text;
}

TEST_F(Manners, ATruncatedFileIsRefused) {
  ASSERT_EQ(Tool("scale_mesh --mesh=" + Box() + " --category=vehicle --out=" + Path("m.h5")).code, 0);
  fs::resize_file(Path("m.h5"), fs::file_size(Path("m.h5")) / 2);
  const Outcome outcome = Tool("decompose --mesh=" + Path("m.h5") + " --out=" + Path("p.h5"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("m.h5"));
  EXPECT_EQ(outcome.lines(), 1) << outcome.text;
}

}  // namespace
}  // namespace dexremoe
