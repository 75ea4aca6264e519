// One small cube made ready for training by the tools themselves, in about a second.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace dexremoe {

class TrainingTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder() =
        std::filesystem::temp_directory_path() / ("dexremoe_training_" + std::to_string(getpid()));
    std::filesystem::remove_all(folder());
    const std::string cube = Path("objects/cube/"), config = " --config=" + Path("tiny.toml");
    std::filesystem::create_directories(cube);
    std::ofstream(Path("tiny.toml")) << kTiny;
    const std::string lines[] = {
        "make_objects --recipes=data/shapes --out=" + Path("meshes"),
        "list_objects --train_fraction=1 --meshes=" + Path("meshes") +
            " --folder=" + Path("objects") + " --out=" + Path("objects.csv"),
        "scale_mesh --scale.scale=0.55 --name=cube --category=vehicle --mesh=" +
            Path("meshes/vehicle/cube.ply") + " --out=" + cube + "mesh.h5",
        "decompose --mesh=" + cube + "mesh.h5 --out=" + cube + "parts.h5",
        "sample_cloud --mesh=" + cube + "mesh.h5 --out=" + cube + "cloud.h5",
        "train_shape --objects=" + Path("objects.csv") + " --out=" + Path("net.h5") + config,
        "describe_shape --net=" + Path("net.h5") + " --cloud=" + cube + "cloud.h5 --out=" + cube +
            "shape.h5",
        "find_grasps --grasp.count=8 --sim.engine=lanes --mesh=" + cube +
            "mesh.h5 --parts=" + cube + "parts.h5 --out=" + cube + "grasps.h5"};
    for (const std::string& line : lines)
      ASSERT_EQ(std::system((Bin() + line + " >" + Path("log.txt") + " 2>&1").c_str()), 0)
          << line << "\n"
          << Slurp(Path("log.txt"));
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder()); }

  static std::string Path(const std::string& name) { return (folder() / name).string(); }
  static std::string Bin() {
    const char* bin = std::getenv("DEX_BIN");
    return (bin != nullptr ? std::string(bin) : "build/bin") + "/";
  }
  static std::string Slurp(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  // A training of the base policy that takes about a second; further words are appended.
  static std::string TrainBase(const std::string& name, const std::string& words = "") {
    return Bin() + "train_base --config=" + Path("tiny.toml") +
           " --objects=" + Path("objects.csv") + " --out=" + Path(name + ".h5") +
           " --curve=" + Path(name + ".csv") + " --tensorboard=" + Path("tensorboard/" + name) +
           " " + words;
  }

  // A shell line in a process group of its own, its output in NAME.txt.
  static pid_t Start(const std::string& line, const std::string& name) {
    const pid_t child = fork();
    if (child != 0) return child;
    setpgid(0, 0);
    const std::string quiet = "exec " + line + " >" + Path(name + ".txt") + " 2>&1";
    execl("/bin/sh", "sh", "-c", quiet.c_str(), nullptr);
    _exit(127);
  }
  // Exit code, or 128 + the signal that ended it.
  static int Wait(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  static int Run(const std::string& line, const std::string& name) {
    return Wait(Start(line, name));
  }

 private:
  static constexpr char kTiny[] = R"([shape]
points = 64
sa1_centroids = 8
sa1_neighbors = 8
sa1_widths = [8]
sa2_centroids = 4
sa2_neighbors = 4
sa2_widths = [8]
sa3_widths = [8]
head_widths = [8]
epochs = 1
epoch_clouds = 8
[sim]
engine = "lanes"
[policy]
hidden = 16
cloud_widths = [8]
extrinsics_widths = [16]
z_size = 8
[ppo]
envs = 32
horizon = 8
minibatch = 128
mini_epochs = 2
block_rows = 32
stats_window = 40
[train_base]
samples = 20480
)";
  static std::filesystem::path& folder() {
    static std::filesystem::path path;
    return path;
  }
};

}  // namespace dexremoe
