// What the methods behind checkpoints are, as a Markdown table.
#include <cstdio>
#include <string>
#include <vector>

#include "base/options.h"
#include "io/atomic_file.h"
#include "rl/method_card.h"

int main(int argc, char** argv) {
  std::vector<std::string> policies;
  std::string out;
  bool missing = false;
  dexremoe::Options options(
      "list_methods",
      "Lists methods: inputs, network, parameters, losses, curriculum and samples, as their "
      "checkpoints say.",
      "list_methods --policies=base.h5,switch.h5 --out=tables/methods.md");
  options.Add("policies", &policies, "checkpoints or weights").Required();
  options.Add("missing", &missing, "rows whose files are not there say so, instead of an error");
  options.Add("out", &out, "Markdown to write").Required().NotStored();
  return dexremoe::RunTool(options, argc, argv, [&] {
    const std::string table = dexremoe::MethodTable(policies, missing);
    dexremoe::WriteFile(out, table);
    std::fputs(table.c_str(), stdout);
  });
}
