#include "base/error.h"
#include "eval/plots.h"

namespace dexremoe {
namespace {

constexpr double kGroupWidth = 0.8;  // of the distance between two metrics

Metrics TrainingMetrics(const EvaluatedMethod& method, double tolerance) {
  const auto episodes = EpisodesOfSplit(method.eval, RunAt(method, tolerance), "train");
  if (episodes.empty()) Fail("{}: expected episodes on training objects, found none", method.label);
  return ComputeMetrics(episodes, {});
}

std::string AblationData(const std::vector<EvaluatedMethod>& methods, double tolerance) {
  std::string data = "# place metric value low high\n";
  const double step = kGroupWidth / static_cast<double>(methods.size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    data += fmt::format("{}# {}\n", m > 0 ? "\n\n" : "", methods[m].label);
    const Metrics metrics = TrainingMetrics(methods[m], tolerance);
    for (int k = 0; k < kNumPaperMetrics; ++k) {
      const Metric metric = static_cast<Metric>(k);
      const Estimate& e = metrics[metric];
      data += fmt::format("{:.4f} {} {:.6g} {:.6g} {:.6g}\n",
                          k - kGroupWidth / 2 + step * (static_cast<double>(m) + 0.5),
                          Info(metric).name, e.value, e.low, e.high);
    }
  }
  return data;
}

}  // namespace

Figure AblationFigure(const std::vector<EvaluatedMethod>& methods, double tolerance) {
  Figure figure;
  figure.width = 12;
  figure.height = 7.5;
  figure.data = AblationData(methods, tolerance);
  figure.script = fmt::format(
      "set key outside top center horizontal samplen 1.5\n"
      "set border 3 lw 0.7\nset grid ytics lc rgb \"#D8D8D8\" lw 0.5 lt 1\n"
      "set ytics nomirror out scale 0.5\nset boxwidth {:.4f}\nset xrange [-0.6:{}]\n"
      "set yrange [0:*]\nset ylabel \"successes per episode at {} rad\"\n"
      "set xtics nomirror scale 0 (",
      0.92 * kGroupWidth / static_cast<double>(methods.size()), kNumPaperMetrics - 0.4, tolerance);
  for (int k = 0; k < kNumPaperMetrics; ++k)
    figure.script += fmt::format("{}{} {}", k > 0 ? ", " : "",
                                 GnuplotQuoted(Info(static_cast<Metric>(k)).label), k);
  figure.script += ")\nplot ";
  for (std::size_t m = 0; m < methods.size(); ++m)
    figure.script += fmt::format(
        "{0}data index {1} using 1:3 with boxes lc rgb \"{2}\" fs solid 0.85 noborder title {3}, "
        "\\\n  data index {1} using 1:4:(0):($5-$4) with vectors heads size screen 0.005,90 lw 0.9 "
        "lc rgb \"#303030\" "
        "notitle",
        m > 0 ? ", \\\n  " : "", m, PaletteColor(static_cast<int>(m)),
        GnuplotQuoted(methods[m].label));
  figure.script += "\nreset\n";
  return figure;
}

}  // namespace dexremoe
