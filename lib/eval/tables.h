// Tables of results: ours with intervals beside the paper's, as Markdown, CSV and LaTeX.
#pragma once

#include <string>
#include <vector>

#include "eval/eval_file.h"

namespace dexremoe {

// One row label and the evaluations behind it: several files with the same label are seeds of the
// same method, and their episodes are pooled per object. Without any the method is missing: its
// rows say so.
struct MethodResults {
  std::string label;
  std::vector<EvalFile> evals;
};

// One number the paper prints (data/paper_tables.csv: table,method,split,metric,value).
struct PaperNumber {
  std::string table, method, split, metric;
  double value = 0;
};
// Throws Error naming file and line when a split or metric is unknown.
std::vector<PaperNumber> ReadPaperNumbers(const std::string& path);

struct TableRow {
  std::string label;
  bool paper = false;            // printed numbers, without intervals
  std::vector<Estimate> values;  // one per column; NaN where nothing is known
  bool missing = false;          // not evaluated: all values are NaN
};

// A metric over all objects or, where one is named, over those of a category.
struct TableColumn {
  Metric metric = Metric::kMean;
  std::string category;
  std::string name() const;   // key in files: "s_mean", "s_mean:shoe"
  std::string label() const;  // for people: "S_mean", "shoe"
};

// A table of one split at one tolerance.
struct ResultTable {
  std::string split;     // "train" or "ood"
  double tolerance = 0;  // rad
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
  std::string caption;  // objects, episodes, seeds, engine
};

struct TableOptions {
  std::string paper_table = "1";  // which of the paper's
  bool engines = false;           // rows may be of different engines and substeps
  bool categories = false;        // columns are the mean successes on each category, and on all
};

// One table for each split and tolerance that the evaluations hold; the paper's rows stand below
// ours at tolerance 0.4 rad. Throws Error when all methods are missing, or when they were evaluated
// on different objects or, unless rows are engines, with different engines or substeps.
std::vector<ResultTable> MakeTables(const std::vector<MethodResults>& methods,
                                    const std::vector<PaperNumber>& paper,
                                    const TableOptions& options, const BootstrapOptions& bootstrap);

std::string MarkdownOf(const std::vector<ResultTable>& tables);
std::string LatexOf(const std::vector<ResultTable>& tables);
// One line per number: split,tolerance,source,method,metric,value,low,high; source is "ours",
// "paper" or, with empty numbers, "missing".
std::string CsvOf(const std::vector<ResultTable>& tables);
// One line per object and method: object,category,split,tolerance,method,episodes and every object
// metric with its interval. Methods that are missing have none.
std::string ObjectCsvOf(const std::vector<MethodResults>& methods,
                        const BootstrapOptions& bootstrap);

}  // namespace dexremoe
