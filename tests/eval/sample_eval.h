// A made-up evaluation, and helpers of the tests.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

#include "base/error.h"
#include "base/random.h"
#include "eval/eval_file.h"

namespace dexremoe {

inline std::string Path(const std::string& name) {
  return (std::filesystem::path(::testing::TempDir()) /
          ("eval_test_" + std::to_string(getpid()) + "_" + name))
      .string();
}

// The message of the Error that `body` throws.
inline std::string Message(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// Six training objects and two others, both tolerances, ten episodes each.
inline EvalFile SampleEval(double skill, std::uint64_t seed = 1) {
  EvalFile eval;
  eval.policy = "base.h5";
  eval.engine = "ode";
  eval.substeps = 2;
  eval.seed = seed;
  for (int o = 0; o < 8; ++o)
    eval.objects.push_back({"object_" + std::to_string(o), "train", o < 6 ? "train" : "ood"});
  for (const double tolerance : {0.4, 0.1}) {
    EvalRun& run = eval.runs.emplace_back();
    run.tolerance = tolerance;
    Rng rng(seed, Stream::kTest);
    for (int o = 0; o < 8; ++o)
      for (int e = 0; e < 10; ++e) {
        EpisodeRecord r;
        r.object = o;
        r.episode = static_cast<std::uint64_t>(e);
        r.length = 100 + static_cast<int>(rng.Index(501));
        r.end = r.length == 600 ? EpisodeEnd::kTimeout : EpisodeEnd::kFall;
        r.successes = static_cast<int>(skill * tolerance * (o + 1) * rng.Uniform());
        r.still = static_cast<int>(rng.Index(200));
        r.total_reward = rng.Normal();
        r.mean_angle = rng.Uniform();
        r.mean_distance = 0.01 * rng.Uniform();
        run.episodes.push_back(r);
      }
    run.metrics = ComputeMetrics(run.episodes, {100, seed});
  }
  return eval;
}

}  // namespace dexremoe
