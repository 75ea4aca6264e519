#include <algorithm>

#include "base/check.h"
#include "base/error.h"
#include "eval/study_plots.h"

namespace dexremoe {
namespace {

constexpr std::size_t kMostBands = 4;  // lines; beyond that intervals are drawn as bars

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

// Colours repeat after eight lines; dashes tell the next eight apart.
std::string LineScript(const StudyLine& line, std::size_t k, bool band) {
  const int index = static_cast<int>(k);
  const std::string interval =
      band ? fmt::format(
                 "data index {} using 1:3:4 with filledcurves fs solid noborder lc rgb "
                 "\"{}\" notitle",
                 k, PaletteColor(index, 0xC0))
           : fmt::format(
                 "data index {} using 1:3:(0):($4-$3) with vectors nohead lw 0.8 lc rgb "
                 "\"{}\" notitle",
                 k, PaletteColor(index, 0x90));
  return fmt::format(
      "{0}, \\\n  data index {1} using 1:2 with linespoints pt {2} ps 0.45 lw 1.5{3} lc rgb "
      "\"{4}\" title {5}",
      interval, k, k < 8 ? 7 : 5, k < 8 ? "" : " dt 2", PaletteColor(index),
      GnuplotQuoted(line.label));
}

// From zero, unless the values stand closer to each other than to it.
std::string RangeOf(const std::vector<double>& x) {
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  if (*least <= 0.5 * *most) return "[0:*]";
  const double margin = std::max(0.04 * (*most - *least), 1e-3 * *most);
  return fmt::format("[{:.6g}:{:.6g}]", *least - margin, *most + margin);
}

}  // namespace

Figure StudyFigure(const std::vector<EvaluatedMethod>& methods, const std::vector<double>& x,
                   const std::string& x_label, double tolerance,
                   const std::vector<std::string>& missing) {
  DEX_CHECK_EQ(methods.size(), x.size());
  const std::vector<StudyLine> lines = LinesOf(methods, x, tolerance);
  const bool bands = lines.size() <= kMostBands, inside = bands && missing.empty();
  Figure figure;
  figure.width = inside ? 14 : 17;
  figure.height = 8.5;
  figure.data = StudyData(lines, x_label);
  figure.script = fmt::format(
      "set key {} reverse Left samplen 1.5\n"
      "set border 3 lw 0.7\nset grid ytics lc rgb \"#D8D8D8\" lw 0.5 lt 1\n"
      "set xtics nomirror out scale 0.5\nset ytics nomirror out scale 0.5\n"
      "set xrange {}\nset yrange [0:*]\nset xlabel {}\n"
      "set ylabel \"successes per episode at {} rad\"\nplot ",
      inside ? "top left" : "outside right top", RangeOf(x), GnuplotQuoted(x_label), tolerance);
  for (std::size_t k = 0; k < lines.size(); ++k)
    figure.script += (k > 0 ? ", \\\n  " : "") + LineScript(lines[k], k, bands);
  for (const std::string& label : missing)
    figure.script += fmt::format(", \\\n  NaN with lines lc rgb \"#FFFFFF\" title {}",
                                 GnuplotQuoted(label + " (missing)"));
  figure.script += "\nreset\n";
  return figure;
}

Figure GrowthFigure(const std::vector<EvaluatedMethod>& methods, double tolerance,
                    const std::vector<std::string>& missing) {
  std::vector<double> millions;
  for (const EvaluatedMethod& method : methods)
    millions.push_back(1e-6 * static_cast<double>(method.eval.samples));
  return StudyFigure(methods, millions, "samples (millions)", tolerance, missing);
}

}  // namespace dexremoe
