// What `make tables`, `figures` and `reproduce` do, read from what make would run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "run_make.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// A run of which only the base policy and the shape network are there.
class Reproduce : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("dexremoe_reproduce_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "meshes/shoe");
    fs::create_directories(folder_ / "run");
    for (const char* name : {"meshes/shoe/boot.ply", "run/base.h5", "run/shape_net.h5"})
      std::ofstream(folder_ / name) << "nothing is read of this";
  }
  void TearDown() override { fs::remove_all(folder_); }

  // The commands that make would run for `target`.
  std::string Commands(const std::string& target, const std::string& words) const {
    const std::string run = folder_.string();
    const Outcome outcome = Make("-n --no-print-directory EXPERIMENT=1 OBJECTS=" + run +
                                 "/meshes OUT=" + run + "/run " + words + " " + target);
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    return outcome.text;
  }

  fs::path folder_;
};

constexpr char kBase[] = "run/base.h5 --objects=";

TEST_F(Reproduce, WhatIsMadeOfWhatIsThereTrainsNothing) {
  for (const char* target : {"existing-tables", "existing-figures", "reproduced"}) {
    const std::string commands = Commands(target, "EXISTING=1");
    EXPECT_THAT(commands, Not(HasSubstr("bin/train_"))) << target;
    EXPECT_THAT(commands, HasSubstr(kBase)) << target;  // the base is evaluated all the same
  }
  EXPECT_THAT(Commands("experiment", ""), HasSubstr("bin/train_baseline"));
}

TEST_F(Reproduce, OnlyPoliciesThatAreThereAreEvaluated) {
  const std::string commands = Commands("existing-tables", "EXISTING=1");
  EXPECT_THAT(commands, Not(HasSubstr("--policy=" + folder_.string() + "/run/gate.h5")));
  EXPECT_THAT(commands, HasSubstr("tabulate --missing"));
}

TEST_F(Reproduce, WithoutShippedWeightsOneLineSaysWhatToDo) {
  const Outcome outcome = Make("--silent shipped PRETRAINED=" + folder_.string() + "/none");
  EXPECT_NE(outcome.code, 0);
  EXPECT_THAT(outcome.text, HasSubstr("/none is empty: train a run"));
}

TEST_F(Reproduce, DamagedWeightsAreNamed) {
  const fs::path shipped = folder_ / "shipped";
  fs::create_directories(shipped);
  std::ofstream(shipped / "base.h5") << "weights";
  std::ofstream(shipped / "manifest.csv")
      << "file,method,samples,seed,sha256\nbase.h5,base,5,1," << std::string(64, '0') << "\n";
  const Outcome outcome = Make("--silent shipped PRETRAINED=" + shipped.string());
  EXPECT_NE(outcome.code, 0);
  EXPECT_THAT(outcome.text, HasSubstr("shipped/base.h5: FAILED"));
}

}  // namespace
}  // namespace dexremoe
