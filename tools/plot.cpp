// Figures through gnuplot: learning curves, successes per object and against samples, the map of
// the gate's weights.
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "eval/plots.h"

namespace {

using namespace dexremoe;

struct PlotOptions {
  std::string kind, out, x = "samples", color = "cluster";
  std::vector<std::string> in, labels, columns;
  double smooth = 0.05, tolerance = 0.4;
  bool missing = false;

  void Register(Options& options) {
    options.Add("kind", &kind, "what to draw")
        .Required()
        .Choices({"curves", "bars", "growth", "ablation", "tsne"});
    options
        .Add("in", &in,
             "curves: CSV files; bars, growth, ablation: dexremoe.eval; tsne: dexremoe.embedding")
        .Required();
    options.Add("labels", &labels, "names of the files in the legend; the file names when absent");
    options.Add("missing", &missing,
                "files that are not there are named in the figure, instead of an error");
    options.Add("out", &out, "figure without ending: OUT.png, .pdf, .dat and .gp are written")
        .Required()
        .NotStored();
    options.Add("x", &x, "curves: column on the abscissa");
    options.Add("columns", &columns, "curves: one panel each; the usual ones when absent");
    options.Add("smooth", &smooth, "curves: smooth over this part of the rows").Range(0, 1);
    options.Add("tolerance", &tolerance, "bars, growth, ablation: which tolerance, rad")
        .Range(0, 3.15);
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

// Takes files that are not there out of --in and --labels; returns their labels.
std::vector<std::string> TakeMissing(PlotOptions& o) {
  std::vector<std::string> in, labels, gone;
  for (std::size_t i = 0; i < o.in.size(); ++i) {
    const bool there = !o.missing || std::filesystem::exists(o.in[i]);
    (there ? labels : gone).push_back(o.labels[i]);
    if (there) in.push_back(o.in[i]);
  }
  if (in.empty()) Fail("expected at least one of {} files in --in, found none", o.in.size());
  o.in = in;
  o.labels = labels;
  return gone;
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
  if (o.kind == "curves") return CurvesFigure(curves, o.x, o.columns, o.smooth);
  if (o.kind == "ablation") return AblationFigure(methods, o.tolerance);
  return o.kind == "growth" ? GrowthFigure(methods, o.tolerance) : BarsFigure(methods, o.tolerance);
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
    const std::vector<std::string> gone = TakeMissing(plot);
    Figure figure = Draw(plot);
    NoteMissing(gone, figure);
    WriteFigure(plot.out, figure);
    std::printf("%s.png\n%s.pdf\n", plot.out.c_str(), plot.out.c_str());
  });
}
