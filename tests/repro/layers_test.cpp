// The layer table of ARCHITECTURE.md, enforced on the sources.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kModules = {"base", "io",   "geometry", "nn", "shape", "hand",
                                           "sim",  "task", "policy",   "rl", "eval",  "render"};

// Third-party header prefixes and the one folder of lib/ that may include them.
const std::map<std::string, std::string> kOwners = {
    {"CLI/", "base"},      {"toml++/", "base"},    {"spdlog/spdlog.h", "base"},
    {"spdlog/sinks", "base"}, {"hdf5", "io"},      {"png.h", "io"},
    {"xxhash.h", "io"},    {"assimp/", "geometry"}, {"libqhull", "geometry"},
    {"dnnl", "nn"},        {"oneapi/dnnl", "nn"},  {"pcl/", "shape"},
    {"urdf", "hand"},       {"console_bridge/", "hand"},      {"ode/", "sim/ode"},    {"ccd/", "sim/ode"},
    {"mujoco/", "sim/mujoco"}, {"hwy/", "sim/lanes"},
    {"mpi.h", "rl"},       {"GL/", "render"},     {"ft2build.h", "render"}, {"freetype/", "render"}};

std::vector<fs::path> Sources(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
      files.push_back(entry.path());
  return files;
}

std::string Slurp(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> Includes(const std::string& text) {
  static const std::regex pattern(R"(#include\s*[<"]([^>"]+)[>"])");
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it)
    found.push_back((*it)[1]);
  return found;
}

int Rank(const std::string& module) {
  for (std::size_t i = 0; i < kModules.size(); ++i)
    if (kModules[i] == module) return static_cast<int>(i);
  return -1;
}

TEST(Layers, SourcesAreFoundFromTheProjectRoot) {
  ASSERT_TRUE(fs::exists("lib/base/error.h")) << "run the tests from the project's top folder";
  EXPECT_GT(Sources("lib").size(), 50u);
}

TEST(Layers, EveryFolderOfLibIsAModule) {
  for (const auto& entry : fs::directory_iterator("lib"))
    EXPECT_GE(Rank(entry.path().filename()), 0) << entry.path();
}

TEST(Layers, AModuleIncludesOnlyModulesBelowIt) {
  for (const fs::path& file : Sources("lib")) {
    const std::string module = *std::next(file.begin());
    for (const std::string& include : Includes(Slurp(file))) {
      const int rank = Rank(include.substr(0, include.find('/')));
      EXPECT_LE(rank, Rank(module)) << file << " includes " << include;  // -1: not ours
    }
  }
}

TEST(Layers, ThirdPartyHeadersStayInTheirModule) {
  for (const fs::path& file : Sources("lib"))
    for (const std::string& include : Includes(Slurp(file)))
      for (const auto& [prefix, owner] : kOwners)
        if (include.starts_with(prefix)) {
          const std::string place = file.string().substr(4);
          EXPECT_TRUE(place.starts_with(owner + "/")) << file << " includes " << include;
        }
}

TEST(Layers, ToolsAndTestsLeaveThirdPartyHeadersToTheLibrary) {
  for (const fs::path& file : Sources("tools"))
    for (const std::string& include : Includes(Slurp(file)))
      for (const auto& [prefix, owner] : kOwners)
        EXPECT_FALSE(include.starts_with(prefix)) << file << " includes " << include;
}

TEST(Layers, TheLibraryNeitherExitsNorPrintsNorUsesGlobalRandomNumbers) {
  const std::regex forbidden(
      R"((std::cout|[^a-zA-Z_:.>](exit|_exit|rand|srand|printf|puts)\s*\(|std::(exit|rand|srand|printf|puts)\b|random_device))");
  for (const fs::path& file : Sources("lib")) {
    if (file == "lib/base/options.cpp") continue;   // RunTool is the tools' main function
    if (file == "lib/base/confined.cpp") continue;  // ends the process that it has forked
    std::istringstream lines(Slurp(file));
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
      const std::string code = line.substr(0, line.find("//"));
      EXPECT_FALSE(std::regex_search(code, forbidden)) << file << ":" << number << ": " << line;
    }
  }
}

TEST(Layers, ToolsAreThin) {
  for (const fs::path& file : Sources("tools")) {
    const std::string text = Slurp(file);
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 150) << file;
  }
}

TEST(Layers, DeviationsFromThePaperCarryTheMarkThatGrepFinds) {
  int marks = 0;
  for (const fs::path& file : Sources("lib"))
    if (Slurp(file).find("NOTE(paper)") != std::string::npos) ++marks;
  EXPECT_GT(marks, 5);
}

}  // namespace
}  // namespace dexremoe
