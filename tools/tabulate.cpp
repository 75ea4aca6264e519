// Tables of evaluation results beside the paper's: Markdown, CSV and LaTeX.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "base/options.h"
#include "eval/tables.h"
#include "io/atomic_file.h"

namespace {

// Files with the same label are seeds of one method. With `missing`, those that are not there are
// left out.
std::vector<dexremoe::MethodResults> Group(const std::vector<std::string>& files,
                                           const std::vector<std::string>& labels, bool missing) {
  if (files.size() != labels.size())
    throw dexremoe::UsageError(
        fmt::format("--labels: expected as many as files in --eval ({}), found {}", files.size(),
                    labels.size()));
  std::vector<dexremoe::MethodResults> methods;
  for (std::size_t i = 0; i < files.size(); ++i) {
    std::size_t m = 0;
    while (m < methods.size() && methods[m].label != labels[i]) ++m;
    if (m == methods.size()) methods.push_back({labels[i], {}});
    if (missing && !std::filesystem::exists(files[i]))
      dexremoe::LogWarning("missing: {}", files[i]);
    else
      methods[m].evals.push_back(dexremoe::ReadEval(files[i]));
  }
  return methods;
}

// The paper's numbers; of these methods alone unless there are none.
std::vector<dexremoe::PaperNumber> PaperNumbers(const std::string& path,
                                                const std::vector<std::string>& methods) {
  if (path.empty()) return {};
  std::vector<dexremoe::PaperNumber> numbers = dexremoe::ReadPaperNumbers(path);
  if (!methods.empty())
    std::erase_if(numbers, [&](const dexremoe::PaperNumber& number) {
      return std::find(methods.begin(), methods.end(), number.method) == methods.end();
    });
  return numbers;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files, labels, paper_methods;
  std::string paper, out;
  dexremoe::TableOptions table;
  bool missing = false;
  dexremoe::BootstrapOptions bootstrap;
  dexremoe::Options options(
      "tabulate",
      "Writes OUT.md, OUT.csv, OUT.tex and OUT_objects.csv from evaluations, with 95 % intervals, "
      "beside the numbers of the paper.",
      "tabulate --eval=eval/base.h5,eval/gate.h5 --labels=\"Base,DexReMoE\" "
      "--paper=data/paper_tables.csv --out=tables/table1");
  options.Add("eval", &files, "evaluations (dexremoe.eval), one per row").Required();
  options.Add("labels", &labels, "row labels; equal labels are seeds of one method").Required();
  options.Add("paper", &paper, "CSV with the paper's numbers; empty leaves them out");
  options.Add("paper_table", &table.paper_table, "which of the paper's tables");
  options.Add("paper_methods", &paper_methods, "which rows of it; none: all");
  options.Add("missing", &missing, "rows whose files are not there say so, instead of an error");
  options.Add("engines", &table.engines, "rows are physics engines, not methods");
  options.Add("categories", &table.categories, "columns are S_mean on each category, and on all");
  options.Add("resamples", &bootstrap.resamples, "bootstrap resamples").Range(0, 1e6);
  options.Add("seed", &bootstrap.seed, "seed of the bootstrap");
  options.Add("out", &out, "path without ending").Required().NotStored();
  return dexremoe::RunTool(options, argc, argv, [&] {
    const auto methods = Group(files, labels, missing);
    const auto numbers = PaperNumbers(paper, paper_methods);
    const auto tables = dexremoe::MakeTables(methods, numbers, table, bootstrap);
    const std::string markdown = dexremoe::MarkdownOf(tables);
    dexremoe::WriteFile(out + ".csv", dexremoe::CsvOf(tables));
    dexremoe::WriteFile(out + ".tex", dexremoe::LatexOf(tables));
    dexremoe::WriteFile(out + "_objects.csv", dexremoe::ObjectCsvOf(methods, bootstrap));
    dexremoe::WriteFile(out + ".md", markdown);
    std::fputs(markdown.c_str(), stdout);
  });
}
