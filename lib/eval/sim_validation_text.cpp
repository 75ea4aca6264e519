// The report of validate_sim.
#include <spdlog/fmt/fmt.h>

#include "eval/sim_validation.h"

namespace dexremoe {

std::string SimValidation::Markdown() const {
  std::string text = "# Accuracy of the physics engines\n";
  if (!notes.empty()) text += "\n" + notes;
  const auto section = [&](const std::string& title, const std::string& table,
                           const std::string& corner, const std::string& reading) {
    const std::string body = MarkdownOf(measurements, table, corner);
    if (!body.empty()) text += fmt::format("\n## {}\n\n{}\n\n{}", title, reading, body);
  };
  text +=
      "\nA label is engine and substeps of a 60 Hz control step; for lanes it is substeps x inner "
      "steps x iterations. The referee is MuJoCo at the most substeps shown. `-`: needs an engine "
      "that is left out, or nothing to measure.\n";
  section("Goals", "goals", "", "The default setting against what it has to reach.");
  section(
      "Motion without contact", "motion", "setting",
      "Free fall for one second: distance from g t^2 / 2 and from g t. A block that tumbles for "
      "one second: relative change of its angular momentum (a vector) and energy.");
  section("Joint steps", "joint", "setting",
          "All targets jump by so much at once: largest difference of a joint angle from the "
          "referee's within half a second, rad.");
  section("Slip angle", "slip", "setting",
          "A flat block on a tilted board: angle at which it begins to slide minus atan(friction), "
          "degrees, the worst of three directions. Looked for within 8 degrees.");
  section("Grasps found", "found", "engine", "Grasps found (accepted share of the candidates).");
  for (const char* engine : {"ode", "lanes", "mujoco"})
    section(fmt::format("Grasps found by {}", engine), fmt::format("held {}", engine),
            "replayed in", "Share that holds the object within 3 cm for one second, %.");
  section(
      "Rest", "quiet", "setting",
      "Share of the grasps that hold, whoever found them, whose object stays below both success "
      "thresholds over the last half second (root mean square of finite differences at the "
      "control rate), %.");
  section("Slippery cubes", "friction", "setting",
          "Share of all engines' cube grasps (found at a friction near 1) that hold, %.");
  section("Survival under random targets", "survival", "setting",
          "Control steps until the object is lost (at most one episode), mean +- standard error; "
          "equal starts and equal noise for all.");
  section("Penetration under random targets", "depth", "setting",
          "Deepest hand-object contact at the control steps, as the engine reports it: 95 %, 99 %, "
          "largest, mm.");
  return text;
}

}  // namespace dexremoe
