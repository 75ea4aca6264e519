// An engine at chosen steps, under the name that tables show.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hand/hand_model.h"
#include "sim/batch_sim.h"

namespace dexremoe {

struct EngineSetting {
  std::string label;  // "ode 2", "lanes 2x2x3": substeps x inner steps x iterations
  SimOptions sim;
};

// `base` with another engine and other steps. inner_steps and iterations count for lanes alone.
EngineSetting SettingOf(const SimOptions& base, const std::string& engine, int substeps,
                        int inner_steps = 0, int iterations = 0);

// Why this build or machine cannot run the engine; empty when it can.
std::optional<std::string> WhyMissing(const std::string& engine, const HandModel& hand);

// The engines of "lanes", "ode", "mujoco" that run here. The others are told to `note` in one line
// each.
std::vector<std::string> AvailableEngines(const HandModel& hand, std::string* note);

}  // namespace dexremoe
