// bench_sim, bench_learn and validate_sim from the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

class SimTools : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("dexremoe_sim_tools_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  // Runs a tool quietly; its output goes to NAME.txt.
  int Run(const std::string& words, const std::string& name) const {
    const char* bin = std::getenv("DEX_BIN");
    return std::system(((bin != nullptr ? bin : "build/bin") + ("/" + words) + " >" +
                        Path(name + ".txt") + " 2>/dev/null")
                           .c_str());
  }
  std::string Slurp(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(Path(name)).rdbuf();
    return text.str();
  }

  fs::path folder_;
};

TEST_F(SimTools, BenchSimWritesWhatItPrints) {
  ASSERT_EQ(Run("bench_sim --quick --out=" + Path("a.md") + " --csv=" + Path("a.csv"), "a"), 0);
  EXPECT_EQ(Slurp("a.md"), Slurp("a.txt"));
  EXPECT_THAT(Slurp("a.md"), HasSubstr("| ode 2"));
  EXPECT_THAT(Slurp("a.csv"), StartsWith("table,row,column,value,spread\nrate,"));
}

TEST_F(SimTools, BenchLearnWritesWhatItPrints) {
  ASSERT_EQ(Run("bench_learn --quick --out=" + Path("a.md") + " --csv=" + Path("a.csv"), "a"), 0);
  EXPECT_EQ(Slurp("a.md"), Slurp("a.txt"));
  EXPECT_THAT(Slurp("a.md"), HasSubstr("| 128 x 2, f32"));
  EXPECT_THAT(Slurp("a.csv"), StartsWith("table,row,column,value,spread\nrate,"));
}

TEST_F(SimTools, ValidateSimGivesTheSameBytesForAnyNumberOfWorkersSlow) {
  for (const std::string workers : {"1", "2"})
    ASSERT_EQ(Run("validate_sim --quick --workers=" + workers + " --out=" + Path(workers + ".md") +
                      " --csv=" + Path(workers + ".csv"),
                  workers),
              0);
  EXPECT_EQ(Slurp("1.md"), Slurp("1.txt"));
  EXPECT_EQ(Slurp("1.md"), Slurp("2.md"));
  EXPECT_EQ(Slurp("1.csv"), Slurp("2.csv"));
  EXPECT_THAT(Slurp("1.md"), HasSubstr("| ode 2"));
}

}  // namespace
}  // namespace dexremoe
