#include "eval/sim_setting.h"

#include "base/error.h"
#include "eval/sim_scenes.h"

namespace dexremoe {

EngineSetting SettingOf(const SimOptions& base, const std::string& engine, int substeps,
                        int inner_steps, int iterations) {
  EngineSetting setting = {fmt::format("{} {}", engine, substeps), base};
  setting.sim.engine = engine;
  setting.sim.substeps = substeps;
  if (engine == "lanes") {
    if (inner_steps > 0) setting.sim.inner_steps = inner_steps;
    if (iterations > 0) setting.sim.iterations = iterations;
    setting.label =
        fmt::format("lanes {}x{}x{}", substeps, setting.sim.inner_steps, setting.sim.iterations);
  }
  return setting;
}

std::optional<std::string> WhyMissing(const std::string& engine, const HandModel& hand) {
  try {
    SimOptions options;
    options.engine = engine;
    ThreadPool pool(1);
    MakeBatchSim(options, hand, {BoxObject("cube", Eigen::Vector3d::Constant(0.05))}, 1, pool);
    return std::nullopt;
  } catch (const Error& error) {
    return error.what();
  }
}

std::vector<std::string> AvailableEngines(const HandModel& hand, std::string* note) {
  std::vector<std::string> engines;
  for (const char* engine : {"lanes", "ode", "mujoco"}) {
    const auto missing = WhyMissing(engine, hand);
    if (missing)
      *note += fmt::format("{} is left out: {}\n", engine, *missing);
    else
      engines.push_back(engine);
  }
  return engines;
}

}  // namespace dexremoe
