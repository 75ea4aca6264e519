// A small training run on the toy task.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "base/error.h"
#include "base/thread_pool.h"
#include "rl/checkpoint.h"
#include "rl/start.h"
#include "rl/trainer.h"
#include "toy_env.h"

namespace dexremoe {

inline PpoOptions ToyPpo() {
  PpoOptions o;
  o.envs = 96;
  o.horizon = 20;
  o.minibatch = 640;
  o.mini_epochs = 4;
  o.block_rows = 128;
  o.gamma = 0.9;
  o.learning_rate = 1e-3;
  o.precision = "f32";  // the same everywhere; tests of bf16 ask for it
  return o;
}

inline PolicyOptions ToyPolicy() {
  PolicyOptions p;
  p.hidden = 24;
  p.cloud_widths = {12, 8};
  p.extrinsics_widths = {16};
  p.z_size = 8;
  p.log_std = -0.5;
  return p;
}

// Objects of one sign share neither descriptor nor category.
inline ShapeTable ToyTable(std::vector<int> objects = {0, 1, 2, 3}) {
  ShapeTable table;
  for (const int k : objects) {
    Rng rng(11, Stream::kTest, {static_cast<std::uint64_t>(k)});
    table.names.push_back("toy" + std::to_string(k));
    table.category.push_back(k);
    for (int i = 0; i < kShapeFeatureSize; ++i)
      table.feature.push_back(static_cast<float>(rng.Normal()));
  }
  return table;
}

inline StageStart ToyStart(const PpoOptions& ppo = ToyPpo(), std::uint64_t seed = 1) {
  return {ppo, {}, ToyTable(), seed};
}

inline TrainState ToyBase(const PpoOptions& ppo = ToyPpo(), std::uint64_t seed = 1) {
  return StartBase(ToyStart(ppo, seed), ToyPolicy(), 4, 2, 2);
}

// A trainer with its own environments and threads.
struct ToyRun {
  explicit ToyRun(TrainState state, int workers = 2, const PpoOptions& ppo = ToyPpo())
      : pool(workers), env(ppo.envs, 7), trainer(ppo, {}, std::move(state), env, pool) {}
  void Iterate(int count) {
    for (int i = 0; i < count; ++i) trainer.Iterate();
  }
  ThreadPool pool;
  ToyEnv env;
  Trainer trainer;
};

inline Provenance ToyProvenance() { return {"test", "samples = 1\nseed = 1\n", 1, {}}; }

// The objects of ToyTable.
inline std::vector<TaskObject> ToyObjects() {
  const ShapeTable table = ToyTable();
  std::vector<TaskObject> objects(table.objects());
  for (int k = 0; k < table.objects(); ++k) {
    objects[k].name = table.names[k];
    objects[k].category = table.category[k];
    objects[k].feature.assign(table.feature.begin() + k * kShapeFeatureSize,
                              table.feature.begin() + (k + 1) * kShapeFeatureSize);
  }
  return objects;
}

// What the Error says that `body` throws.
inline std::string MessageOf(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// A path in a folder of its own, removed at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("dexremoe_rl_" + name)) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace dexremoe
