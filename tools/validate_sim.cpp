// Compares the physics engines with closed forms and with each other.
#include <spdlog/fmt/fmt.h>

#include "base/options.h"
#include "eval/sim_scenes.h"
#include "eval/sim_validation.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

struct ValidateSimOptions {
  std::string out, csv;
  int workers = 0;
  bool quick = false;
  SimValidationOptions validation;
  TaskOptions task;
  HandOptions hand;

  void Register(Options& options) {
    options.Add("out", &out, "Markdown file to write").NotStored();
    options.Add("csv", &csv, "the same numbers as CSV").NotStored();
    options.Add("workers", &workers, "threads; 0: one per processor").Range(0, 1024).NotStored();
    options.Add("quick", &quick, "small sizes that show that everything runs");
    validation.Register(options);
    task.Register(options);
    hand.Register(options);
  }
};

void Run(ValidateSimOptions& o) {
  o.task.Check();
  if (o.quick) o.validation.MakeQuick();
  ThreadPool pool(o.workers);
  const SimValidation result =
      ValidateSim(o.validation, LoadHand(o.hand), o.task, ValidationShapes(), pool);
  const std::string text = result.Markdown();
  if (!o.out.empty()) WriteFile(o.out, text);
  if (!o.csv.empty()) WriteFile(o.csv, CsvOf(result.measurements));
  fmt::print("{}", text);
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("validate_sim", "Compares the physics engines with closed forms and each other.",
                  "validate_sim --out=results/bench/validate_sim.md");
  ValidateSimOptions o;
  o.Register(options);
  return RunTool(options, argc, argv, [&] { Run(o); });
}
