#include "base/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace dexremoe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A tool with one option of every kind.
struct Tool {
  int whole = 3;
  std::int64_t large = -5;
  std::uint64_t seed = 7;
  double real = 0.5;
  bool flag = false;
  std::string text = "abc";
  std::string engine = "ode";
  std::vector<double> reals = {1, 2};
  std::vector<int> wholes = {4};
  std::vector<std::string> names;
  std::string out;
  Options options{"test_tool", "A tool.", "test_tool --whole=3"};

  Tool() {
    options.Add("whole", &whole, "a whole number").Range(1, 64);
    options.Add("large", &large, "another");
    options.Add("seed", &seed, "seed");
    options.Add("real", &real, "a real number, m");
    options.Add("flag", &flag, "a switch");
    options.Add("text", &text, "text");
    options.Add("sim.engine", &engine, "engine").Choices({"ode", "lanes"});
    options.Add("eval.reals", &reals, "real numbers").Range(0, 10);
    options.Add("wholes", &wholes, "whole numbers");
    options.Add("names", &names, "names");
    options.Add("out", &out, "output").NotStored();
  }
  bool Parse(std::vector<std::string> words) {
    std::vector<const char*> argv = {"test_tool"};
    for (const std::string& word : words) argv.push_back(word.c_str());
    return options.Parse(static_cast<int>(argv.size()), argv.data());
  }
};

// The message of the UsageError that these words cause.
std::string UsageMessage(const std::vector<std::string>& words) {
  Tool tool;
  try {
    tool.Parse(words);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

std::string WriteConfig(const std::string& name, const std::string& text) {
  const std::string path =
      (std::filesystem::path(::testing::TempDir()) / (name + ".toml")).string();
  std::ofstream(path) << text;
  return path;
}

TEST(Options, EveryTypeIsReadFromTheCommandLine) {
  Tool tool;
  ASSERT_TRUE(tool.Parse({"--whole=12", "--large=-9000000000", "--seed=18446744073709551615",
                          "--real=-1.5e-3", "--flag", "--text=a b=c", "--sim.engine=lanes",
                          "--eval.reals=0.4,0.1", "--wholes=1,2,3", "--names=x,y"}));
  EXPECT_EQ(tool.whole, 12);
  EXPECT_EQ(tool.large, -9000000000);
  EXPECT_EQ(tool.seed, 18446744073709551615ull);
  EXPECT_EQ(tool.real, -1.5e-3);
  EXPECT_TRUE(tool.flag);
  EXPECT_EQ(tool.text, "a b=c");
  EXPECT_EQ(tool.engine, "lanes");
  EXPECT_THAT(tool.reals, ElementsAre(0.4, 0.1));
  EXPECT_THAT(tool.wholes, ElementsAre(1, 2, 3));
  EXPECT_THAT(tool.names, ElementsAre("x", "y"));
}

TEST(Options, DefaultsStandWhenNothingIsSaid) {
  Tool tool;
  ASSERT_TRUE(tool.Parse({}));
  EXPECT_EQ(tool.whole, 3);
  EXPECT_FALSE(tool.flag);
  EXPECT_THAT(tool.reals, ElementsAre(1, 2));
  EXPECT_TRUE(tool.names.empty());
}

TEST(Options, ASwitchTakesAValueToo) {
  Tool on, off;
  on.Parse({"--flag=true"});
  EXPECT_TRUE(on.flag);
  off.Parse({"--flag", "--flag=false"});
  EXPECT_FALSE(off.flag);
  EXPECT_THAT(UsageMessage({"--flag=maybe"}), HasSubstr("flag"));
}

TEST(Options, TheLastOfTwoEqualFlagsWins) {
  Tool tool;
  tool.Parse({"--whole=5", "--whole=6"});
  EXPECT_EQ(tool.whole, 6);
}

TEST(Options, AMisspeltFlagIsNamedWithTheOneThatWasMeant) {
  const std::string message = UsageMessage({"--wohle=3"});
  EXPECT_THAT(message, HasSubstr("--wohle"));
  EXPECT_THAT(message, HasSubstr("did you mean 'whole'?"));
  EXPECT_THAT(UsageMessage({"--engine=ode"}), HasSubstr("unknown option --engine"));
}

TEST(Options, TrailingCharactersAndWrongTypesAreRefused) {
  for (const char* word :
       {"--whole=3x", "--whole=3.5", "--whole=", "--whole", "--whole=1e1", "--real=0.5m",
        "--real=half", "--seed=-1", "--seed=1.0", "--seed=18446744073709551616", "--wholes=1,x",
        "--large=9223372036854775808"})
    EXPECT_NE(UsageMessage({word}), "no error") << word;
  EXPECT_THAT(UsageMessage({"--whole=3x"}), HasSubstr("3x"));
  EXPECT_THAT(UsageMessage({"file.h5"}), HasSubstr("--name=value"));
  EXPECT_THAT(UsageMessage({"--out", "file.h5"}), HasSubstr("file.h5"));
}

TEST(Options, LeadingZerosAreDecimal) {
  Tool tool;
  tool.Parse({"--whole=010"});
  EXPECT_EQ(tool.whole, 10);
}

TEST(Options, RangesAndChoicesNameTheirBounds) {
  const std::string range = UsageMessage({"--whole=65"});
  EXPECT_THAT(range, HasSubstr("--whole"));
  EXPECT_THAT(range, HasSubstr("[1, 64]"));
  EXPECT_THAT(range, HasSubstr("65"));
  EXPECT_NE(UsageMessage({"--eval.reals=1,11"}), "no error");
  EXPECT_NE(UsageMessage({"--eval.reals=nan"}), "no error");
  const std::string choice = UsageMessage({"--sim.engine=mujoco"});
  EXPECT_THAT(choice, HasSubstr("sim.engine"));
  EXPECT_THAT(choice, HasSubstr("ode, lanes"));
  EXPECT_THAT(choice, HasSubstr("mujoco"));
}

TEST(Options, ARequiredOptionThatIsMissingIsNamed) {
  std::string file;
  Options options("test_tool", "A tool.", "test_tool --file=x");
  options.Add("file", &file, "input").Required();
  const char* argv[] = {"test_tool"};
  try {
    options.Parse(1, argv);
    FAIL() << "no error";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--file"));
  }
}

TEST(Options, ConfigFilesStandBetweenDefaultsAndTheCommandLine) {
  const std::string first = WriteConfig("first",
                                        "[test_tool]\nwhole = 10\nreal = 2\nflag = true\n"
                                        "[sim]\nengine = \"lanes\"\n");
  const std::string second = WriteConfig("second", "[test_tool]\nwhole = 11\ntext = \"x\"\n");
  Tool tool;
  tool.Parse({"--config=" + first, "--config=" + second, "--text=y"});
  EXPECT_EQ(tool.whole, 11);
  EXPECT_EQ(tool.real, 2);
  EXPECT_TRUE(tool.flag);
  EXPECT_EQ(tool.engine, "lanes");
  EXPECT_EQ(tool.text, "y");
}

TEST(Options, AListIsReplacedNotGrown) {
  const std::string first = WriteConfig("list1", "[eval]\nreals = [1, 2, 3]\n");
  const std::string second = WriteConfig("list2", "[eval]\nreals = [4]\n");
  Tool a, b, c, d;
  a.Parse({"--config=" + first});
  EXPECT_THAT(a.reals, ElementsAre(1, 2, 3));
  b.Parse({"--config=" + first, "--eval.reals=5"});
  EXPECT_THAT(b.reals, ElementsAre(5));
  c.Parse({"--config=" + first, "--config=" + second});
  EXPECT_THAT(c.reals, ElementsAre(4));
  d.Parse({"--eval.reals=5,6", "--eval.reals=7"});
  EXPECT_THAT(d.reals, ElementsAre(7));
}

TEST(Options, AMisspeltConfigKeyIsNamedWithFileAndSection) {
  const std::string path = WriteConfig("misspelt", "[sim]\nengin = \"ode\"\n");
  const std::string message = UsageMessage({"--config=" + path});
  EXPECT_THAT(message, HasSubstr(path));
  EXPECT_THAT(message, HasSubstr("unknown key 'engin' in [sim]"));
  EXPECT_THAT(message, HasSubstr("did you mean 'engine'?"));
}

TEST(Options, AMisspeltSectionIsAnErrorAForeignOneIsNot) {
  EXPECT_THAT(UsageMessage({"--config=" + WriteConfig("section", "[simm]\nengine = \"ode\"\n")}),
              HasSubstr("unknown section [simm]"));
  Tool tool;
  EXPECT_TRUE(tool.Parse({"--config=" + WriteConfig("foreign", "[ppo]\nwhatever = 1\n")}));
  EXPECT_THAT(UsageMessage({"--config=" + WriteConfig("outside", "whole = 3\n")}),
              HasSubstr("outside any [section]"));
}

TEST(Options, BrokenConfigFilesAreNamed) {
  EXPECT_THAT(UsageMessage({"--config=" + WriteConfig("broken", "[sim]\nengine = \n")}),
              HasSubstr("line 2"));
  EXPECT_THAT(UsageMessage({"--config=/nowhere/x.toml"}), HasSubstr("/nowhere/x.toml"));
  EXPECT_THAT(UsageMessage({"--config=" + WriteConfig("type", "[test_tool]\nwhole = \"many\"\n")}),
              HasSubstr("many"));
  EXPECT_THAT(UsageMessage({"--config=" + WriteConfig("date", "[test_tool]\ntext = 1979-05-27\n")}),
              HasSubstr("text"));
  EXPECT_NE(UsageMessage({"--config=" + WriteConfig("range", "[test_tool]\nwhole = 100\n")}),
            "no error");
}

TEST(Options, TextHoldsWhatChangesTheResultAndNothingElse) {
  Tool tool;
  tool.Parse({"--out=x.h5", "--real=0.1"});
  const std::string text = tool.options.Text();
  EXPECT_THAT(text, HasSubstr("real = 0.1\n"));
  EXPECT_THAT(text, HasSubstr("text = \"abc\"\n"));
  EXPECT_THAT(text, HasSubstr("eval.reals = [1, 2]\n"));
  EXPECT_THAT(text, HasSubstr("flag = false\n"));
  EXPECT_EQ(text.find("x.h5"), std::string::npos);
  EXPECT_EQ(text.find("config"), std::string::npos);
}

TEST(Options, HelpShowsUnitsDefaultsAndTheExample) {
  Tool tool;
  EXPECT_FALSE(tool.Parse({"--help"}));
  EXPECT_THAT(tool.options.help_text(), HasSubstr("a real number, m"));
  EXPECT_THAT(tool.options.help_text(), HasSubstr("test_tool --whole=3"));
  EXPECT_THAT(tool.options.help_text(), HasSubstr("0.5"));
  Tool version;
  EXPECT_FALSE(version.Parse({"--version"}));
  EXPECT_THAT(version.options.help_text(), HasSubstr("test_tool 0."));
}

TEST(RunTool, ExitCodesTellUsageFromFailure) {
  const auto run = [](const std::vector<const char*>& words, const std::function<void()>& body) {
    int n = 1;
    Options options("test_tool", "A tool.", "test_tool --n=1");
    options.Add("n", &n, "number");
    std::vector<const char*> argv = {"test_tool"};
    argv.insert(argv.end(), words.begin(), words.end());
    ::testing::internal::CaptureStderr();
    const int code = RunTool(options, static_cast<int>(argv.size()), argv.data(), body);
    return std::make_pair(code, ::testing::internal::GetCapturedStderr());
  };
  EXPECT_EQ(run({}, [] {}).first, 0);
  EXPECT_EQ(run({"--m=1"}, [] {}).first, 2);
  const auto failed = run({}, [] { Fail("a.h5: expected {}, found {}", 1, 2); });
  EXPECT_EQ(failed.first, 1);
  EXPECT_EQ(failed.second, "test_tool: a.h5: expected 1, found 2\n");
  EXPECT_EQ(run({}, [] { throw UsageError("bad"); }).first, 2);
}

}  // namespace
}  // namespace dexremoe
