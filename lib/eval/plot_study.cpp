#include <algorithm>

#include "base/error.h"
#include "eval/plots.h"

namespace dexremoe {
namespace {

struct GrowthPoint {
  double samples;  // millions
  Estimate successes;
};
struct GrowthLine {
  std::string label;
  std::vector<GrowthPoint> points;
};

// One line per label, in order of first appearance, its points by samples.
std::vector<GrowthLine> LinesOf(const std::vector<EvaluatedMethod>& methods, double tolerance) {
  std::vector<GrowthLine> lines;
  for (const EvaluatedMethod& method : methods) {
    auto line = std::find_if(lines.begin(), lines.end(),
                             [&](const GrowthLine& l) { return l.label == method.label; });
    if (line == lines.end()) line = lines.insert(line, {method.label, {}});
    const Metrics& metrics = RunAt(method, tolerance).metrics;
    line->points.push_back(
        {1e-6 * static_cast<double>(method.eval.samples), metrics[Metric::kMean]});
  }
  for (GrowthLine& line : lines)
    std::stable_sort(
        line.points.begin(), line.points.end(),
        [](const GrowthPoint& a, const GrowthPoint& b) { return a.samples < b.samples; });
  return lines;
}

std::string GrowthData(const std::vector<GrowthLine>& lines) {
  std::string data = "# million samples, S_mean low high\n";
  for (std::size_t k = 0; k < lines.size(); ++k) {
    data += fmt::format("{}# {}\n", k > 0 ? "\n\n" : "", lines[k].label);
    for (const GrowthPoint& p : lines[k].points)
      data += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g}\n", p.samples, p.successes.value,
                          p.successes.low, p.successes.high);
  }
  return data;
}

}  // namespace

Figure GrowthFigure(const std::vector<EvaluatedMethod>& methods, double tolerance) {
  const std::vector<GrowthLine> lines = LinesOf(methods, tolerance);
  Figure figure;
  figure.width = 14;
  figure.height = 8.5;
  figure.data = GrowthData(lines);
  figure.script = fmt::format(
      "set key top left reverse Left samplen 1.5\n"
      "set border 3 lw 0.7\nset grid ytics lc rgb \"#D8D8D8\" lw 0.5 lt 1\n"
      "set xtics nomirror out scale 0.5\nset ytics nomirror out scale 0.5\n"
      "set xrange [0:*]\nset yrange [0:*]\nset xlabel \"samples (millions)\"\n"
      "set ylabel \"successes per episode at {} rad\"\nplot ",
      tolerance);
  for (std::size_t k = 0; k < lines.size(); ++k)
    figure.script += fmt::format(
        "{0}data index {1} using 1:3:4 with filledcurves fs solid noborder lc rgb \"{2}\" notitle, "
        "\\\n  data index {1} using 1:2 with linespoints pt 7 ps 0.4 lw 1.5 lc rgb \"{3}\" title "
        "{4}",
        k > 0 ? ", \\\n  " : "", k, PaletteColor(static_cast<int>(k), 0xC0),
        PaletteColor(static_cast<int>(k)), GnuplotQuoted(lines[k].label));
  figure.script += "\nreset\n";
  return figure;
}

}  // namespace dexremoe
