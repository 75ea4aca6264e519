// The settings that stages depend on: an edit remakes what reads it and nothing else.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "run_make.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

class Settings : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("dexremoe_settings_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    Configure("[scale]\nscale = 0.7\n[ppo]\nenvs = 512\n[eval]\nepisodes = 8\n");
    Remake("");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void Configure(const std::string& text) { std::ofstream(folder_ / "run.toml") << text; }

  // Names of the settings that make rewrites, separated by spaces.
  std::string Remake(const std::string& words) {
    const std::string run = folder_.string();
    std::string targets, rewritten;
    for (const char* name : kNames) targets += " " + run + "/settings/" + name + ".txt";
    const Outcome outcome =
        Make("--silent OUT=" + run + " CONFIG=" + run + "/run.toml " + words + targets);
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    for (const char* name : kNames) {
      const auto time = fs::last_write_time(folder_ / "settings" / (std::string(name) + ".txt"));
      if (times_[name] != time) rewritten += (rewritten.empty() ? "" : " ") + std::string(name);
      times_[name] = time;
    }
    return rewritten;
  }

  static constexpr const char* kNames[] = {"run", "check", "objects", "learning", "eval"};
  fs::path folder_;
  std::map<std::string, fs::file_time_type> times_;
};

TEST_F(Settings, UnchangedTheyKeepTheirTime) { EXPECT_EQ(Remake(""), ""); }

TEST_F(Settings, AnEditedSectionRewritesThoseOfWhatReadsIt) {
  Configure("[scale]\nscale = 0.7\n[ppo]\nenvs = 512\n[eval]\nepisodes = 9\n");
  EXPECT_EQ(Remake(""), "eval");
  Configure("[scale]\nscale = 0.7\n[ppo]\nenvs = 1024\n[eval]\nepisodes = 9\n");
  EXPECT_EQ(Remake(""), "learning");
  Configure("[scale]\nscale = 0.8\n[ppo]\nenvs = 1024\n[eval]\nepisodes = 9\n");
  EXPECT_EQ(Remake(""), "objects");
}

TEST_F(Settings, CommentsAndOtherSectionsRewriteNone) {
  Configure(
      "# A comment.\n\n[scale]\nscale = 0.7  # m\n[tsne]\nperplexity = 9\n[ppo]\nenvs = 512\n"
      "[eval]\nepisodes = 8\n");
  EXPECT_EQ(Remake(""), "");
}

TEST_F(Settings, VariablesRewriteTheirOwn) {
  EXPECT_EQ(Remake("CHECK=lanes"), "check");
  EXPECT_EQ(Remake("CHECK=lanes SEED=2"), "run");
}

}  // namespace
}  // namespace dexremoe
