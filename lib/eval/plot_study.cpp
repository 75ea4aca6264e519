#include <algorithm>

#include "base/check.h"
#include "base/error.h"
#include "eval/panels.h"
#include "eval/study_plots.h"

namespace dexremoe {
namespace {

constexpr std::size_t kMostTogether = 4;  // lines in one panel

struct StudyPoint {
  double x;
  Estimate successes;
};
struct StudyLine {
  std::string label;
  std::vector<StudyPoint> points;
};

// One line per label, in order of first appearance, its points by x.
std::vector<StudyLine> LinesOf(const std::vector<EvaluatedMethod>& methods,
                               const std::vector<double>& x, double tolerance) {
  std::vector<StudyLine> lines;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    auto line = std::find_if(lines.begin(), lines.end(),
                             [&](const StudyLine& l) { return l.label == methods[m].label; });
    if (line == lines.end()) line = lines.insert(line, {methods[m].label, {}});
    line->points.push_back({x[m], RunAt(methods[m], tolerance).metrics[Metric::kMean]});
  }
  for (StudyLine& line : lines)
    std::stable_sort(line.points.begin(), line.points.end(),
                     [](const StudyPoint& a, const StudyPoint& b) { return a.x < b.x; });
  return lines;
}

std::string StudyData(const std::vector<StudyLine>& lines, const std::string& x_label) {
  std::string data = fmt::format("# {}, S_mean low high\n", x_label);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    data += fmt::format("{}# {}\n", k > 0 ? "\n\n" : "", lines[k].label);
    for (const StudyPoint& p : lines[k].points)
      data += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g}\n", p.x, p.successes.value, p.successes.low,
                          p.successes.high);
  }
  return data;
}

std::string LineScript(std::size_t line, const std::string& color) {
  return fmt::format(
      "data index {0} using 1:3:4 with filledcurves fs transparent solid 0.25 noborder lc rgb "
      "\"{1}\" notitle, \\\n  data index {0} using 1:2 with linespoints pt 7 ps 0.4 lw 1.5 lc rgb "
      "\"{1}\"",
      line, color);
}

// The abscissa: from zero, unless the values stand closer to each other than to it.
std::string AbscissaScript(const std::vector<double>& x, int most_tics) {
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  const double from = *least <= 0.5 * *most ? 0 : *least;
  const double span = *most - from, margin = from > 0 ? 0.04 * span : 0;
  if (!(span > 0)) return "set autoscale x\n";
  return fmt::format("set xrange [{:.6g}:{:.6g}]\nset xtics {:.6g}\n", from - margin,
                     *most + 0.02 * span, NiceStep(span, most_tics));
}

// All lines in one panel.
Figure TogetherFigure(const std::vector<StudyLine>& lines, const std::string& data,
                      const std::string& abscissa, const std::string& x_label, double tolerance) {
  Figure figure;
  figure.width = 14;
  figure.height = 8.5;
  figure.data = data;
  figure.script = fmt::format(
      "set key top left reverse Left samplen 1.5\n"
      "set border 3 lw 0.7\nset grid ytics lc rgb \"#D8D8D8\" lw 0.5 lt 1\n"
      "set xtics nomirror out scale 0.5\nset ytics nomirror out scale 0.5\n"
      "{}set yrange [0:*]\nset xlabel {}\n"
      "set ylabel \"successes per episode at {} rad\"\nplot ",
      abscissa, GnuplotQuoted(x_label), tolerance);
  for (std::size_t k = 0; k < lines.size(); ++k)
    figure.script += fmt::format("{}{} title {}", k > 0 ? ", \\\n  " : "",
                                 LineScript(k, PaletteColor(static_cast<int>(k))),
                                 GnuplotQuoted(lines[k].label));
  figure.script += "\nreset\n";
  return figure;
}

// Each line beside the last, in a panel of its own.
Figure PairedFigure(const std::vector<StudyLine>& lines, const std::string& data,
                    const std::string& abscissa, const std::string& x_label,
                    const std::vector<std::string>& missing) {
  double highest = 1e-3;
  panels::Pairs pairs;
  for (const StudyLine& line : lines) {
    pairs.labels.push_back(line.label);
    for (const StudyPoint& p : line.points) highest = std::max(highest, 1.04 * p.successes.high);
  }
  pairs.missing = missing;
  pairs.data = data;
  pairs.x_label = x_label;
  pairs.axes = fmt::format("{}set yrange [0:{:.4g}]\nset ytics {:.4g}\n", abscissa, highest,
                           NiceStep(highest, 5));
  pairs.plot = [](std::size_t line, const char* color, const char*) {
    return LineScript(line, color);
  };
  return PairsFigure(pairs);
}

}  // namespace

Figure StudyFigure(const std::vector<EvaluatedMethod>& methods, const std::vector<double>& x,
                   const std::string& x_label, double tolerance,
                   const std::vector<std::string>& missing) {
  DEX_CHECK_EQ(methods.size(), x.size());
  const std::vector<StudyLine> lines = LinesOf(methods, x, tolerance);
  const std::string data = StudyData(lines, x_label);
  return lines.size() <= kMostTogether && missing.empty()
             ? TogetherFigure(lines, data, AbscissaScript(x, 8), x_label, tolerance)
             : PairedFigure(lines, data, AbscissaScript(x, 5), x_label, missing);
}

Figure GrowthFigure(const std::vector<EvaluatedMethod>& methods, double tolerance,
                    const std::vector<std::string>& missing) {
  std::vector<double> millions;
  for (const EvaluatedMethod& method : methods)
    millions.push_back(1e-6 * static_cast<double>(method.eval.samples));
  return StudyFigure(methods, millions, "samples (millions)", tolerance, missing);
}

}  // namespace dexremoe
