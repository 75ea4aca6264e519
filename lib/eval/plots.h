// The project's figures: learning curves, successes per object, the map of the gate's weights.
#pragma once

#include <string>
#include <vector>

#include "eval/embedding.h"
#include "eval/eval_file.h"
#include "eval/figure.h"
#include "io/csv.h"

namespace dexremoe {

struct Curve {
  std::string label;
  CsvTable table;
};
// One panel per column, one colour per run: the raw values faint, on top a running straight-line
// fit over `smooth` of the rows (0 .. 1). `x` is the column on the abscissa. Without `columns`,
// those of the training curves that the files have. Throws Error when nothing is left to draw.
Figure CurvesFigure(const std::vector<Curve>& curves, const std::string& x,
                    const std::vector<std::string>& columns, double smooth);

// An evaluation and its name in the legend.
struct EvaluatedMethod {
  std::string label;
  EvalFile eval;
};
// The method's run at `tolerance`. Throws Error naming the method when there is none.
const EvalRun& RunAt(const EvaluatedMethod& method, double tolerance);
// S_i with 95 % intervals, grouped by object; objects in ascending order under the last method
// (paper, figure 6). Bars up to 40 objects, points beyond. Throws Error when a method lacks the
// tolerance or the objects differ.
Figure BarsFigure(const std::vector<EvaluatedMethod>& methods, double tolerance);

// The paper's five metrics over the training objects with 95 % intervals, grouped by metric, a bar
// for each method (paper, figure "Ablation Experiments"). Throws Error when a method lacks the
// tolerance or objects.
Figure AblationFigure(const std::vector<EvaluatedMethod>& methods, double tolerance);

// Rows as dots, objects as ringed markers with their number (and name, up to 30 objects); colours by
// "cluster", "category" or "expert" (the one with the largest mean weight).
Figure EmbeddingFigure(const Embedding& embedding, const std::string& color);

}  // namespace dexremoe
