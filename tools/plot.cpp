// Figures through gnuplot: learning curves, successes per object and against samples, pushes or
// sizes, the map of the gate's weights.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "eval/study_plots.h"

namespace {

using namespace dexremoe;

struct PlotOptions {
  std::string kind, out, x = "samples", color = "cluster";
  std::vector<std::string> in, labels, columns;
  std::vector<double> values;
  double smooth = 0.05, tolerance = 0.4;
  std::uint64_t seed = 1;
  bool missing = false;
  std::vector<std::string> gone;  // labels of files that are not there

  void Register(Options& options) {
    options.Add("kind", &kind, "what to draw")
        .Required()
        .Choices({"curves", "bars", "sorted", "hardest", "others", "growth", "study", "ablation",
                  "tsne"});
    options
        .Add("in", &in,
             "curves: CSV files; tsne: dexremoe.embedding; else dexremoe.eval, ours last")
        .Required();
    options.Add("labels", &labels, "names of the files in the legend; the file names when absent");
    options.Add("out", &out, "figure without ending: OUT.png, .pdf, .dat and .gp are written")
        .Required()
        .NotStored();
    options.Add("missing", &missing,
                "files that are not there are named in the figure, instead of an error");
    options.Add("x", &x, "curves: column on the abscissa; study: its label");
    options.Add("values", &values, "study: abscissa of each file");
    options.Add("seed", &seed, "others: seed of the choice");
    options.Add("columns", &columns, "curves: one panel each; the usual ones when absent");
    options.Add("smooth", &smooth, "curves: smooth over this part of the rows").Range(0, 1);
    options.Add("tolerance", &tolerance, "of evaluations: which tolerance, rad").Range(0, 3.15);
    options.Add("color", &color, "tsne: colour by").Choices({"cluster", "category", "expert"});
  }
};

std::vector<std::string> Labels(const PlotOptions& o) {
  if (o.labels.empty()) {
    std::vector<std::string> names;
    for (const std::string& file : o.in)
      names.push_back(std::filesystem::path(file).stem().string());
    return names;
  }
  if (o.labels.size() != o.in.size())
    throw UsageError(fmt::format("--labels: expected as many as files in --in ({}), found {}",
                                 o.in.size(), o.labels.size()));
  return o.labels;
}

// Takes files that are not there out of --in, with their labels and values.
void TakeMissing(PlotOptions& o) {
  std::vector<std::string> in, labels;
  std::vector<double> values;
  for (std::size_t i = 0; i < o.in.size(); ++i) {
    if (o.missing && !std::filesystem::exists(o.in[i])) {
      if (!std::ranges::count(o.gone, o.labels[i])) o.gone.push_back(o.labels[i]);
      continue;
    }
    in.push_back(o.in[i]);
    labels.push_back(o.labels[i]);
    if (i < o.values.size()) values.push_back(o.values[i]);
  }
  if (in.empty()) Fail("expected at least one of {} files in --in, found none", o.in.size());
  o.in = in;
  o.labels = labels;
  o.values = values;
}

Figure Noted(Figure figure, const PlotOptions& o) {
  NoteMissing(o.gone, figure);
  return figure;
}

Figure DrawMethods(const PlotOptions& o, const std::vector<EvaluatedMethod>& methods) {
  constexpr int kHardest = 5, kOthers = 10;  // objects (paper, figure 5)
  if (o.kind == "growth") return GrowthFigure(methods, o.tolerance, o.gone);
  if (o.kind == "sorted") return SortedFigure(methods, o.tolerance, o.gone);
  if (o.kind == "hardest")
    return ObjectPanelsFigure(methods, o.tolerance, HardestObjects(methods, o.tolerance, kHardest),
                              o.gone);
  if (o.kind == "others")
    return ObjectPanelsFigure(methods, o.tolerance,
                              RandomOtherObjects(methods, o.tolerance, kOthers, o.seed), o.gone);
  if (o.kind == "ablation") return Noted(AblationFigure(methods, o.tolerance), o);
  if (o.kind == "bars") return Noted(BarsFigure(methods, o.tolerance), o);
  if (o.values.size() != methods.size())
    throw UsageError(fmt::format("--values: expected as many as files in --in ({}), found {}",
                                 methods.size(), o.values.size()));
  return StudyFigure(methods, o.values, o.x, o.tolerance, o.gone);
}

Figure Draw(const PlotOptions& o) {
  const std::vector<std::string>& labels = o.labels;
  if (o.kind == "tsne") {
    if (o.in.size() != 1)
      throw UsageError(fmt::format("--in: expected one file for tsne, found {}", o.in.size()));
    return EmbeddingFigure(ReadEmbedding(o.in.front()), o.color);
  }
  std::vector<Curve> curves;
  std::vector<EvaluatedMethod> methods;
  for (std::size_t i = 0; i < o.in.size(); ++i) {
    if (o.kind == "curves")
      curves.push_back({labels[i], CsvTable::Read(o.in[i])});
    else
      methods.push_back({labels[i], ReadEval(o.in[i])});
  }
  if (o.kind != "curves") return DrawMethods(o, methods);
  return Noted(CurvesFigure(curves, o.x, o.columns, o.smooth), o);
}

}  // namespace

int main(int argc, char** argv) {
  PlotOptions plot;
  Options options("plot",
                  "Draws a figure as PNG and PDF, with its data and gnuplot script beside it.",
                  "plot --kind=curves --in=base.csv,gate.csv --labels=\"Base,DexReMoE\" "
                  "--out=figures/curves");
  plot.Register(options);
  return RunTool(options, argc, argv, [&] {
    plot.labels = Labels(plot);
    TakeMissing(plot);
    WriteFigure(plot.out, Draw(plot));
    std::printf("%s.png\n%s.pdf\n", plot.out.c_str(), plot.out.c_str());
  });
}
