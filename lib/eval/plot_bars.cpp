#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "eval/study_plots.h"

namespace dexremoe {
namespace {

constexpr std::size_t kMostBars = 40;  // objects; beyond that points with error bars
constexpr double kGroupWidth = 0.8;    // of the distance between two objects

// Objects in ascending order of S under the last method; ties by name.
std::vector<int> SortedObjects(const std::vector<EvaluatedMethod>& methods, double tolerance) {
  const EvalRun& run = RunAt(methods.back(), tolerance);
  const auto& objects = methods.back().eval.objects;
  std::vector<int> order(objects.size());
  std::iota(order.begin(), order.end(), 0);
  const auto score = [&](int o) { return run.metrics.objects[o][ObjectMetric::kSuccesses].value; };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return score(a) != score(b) ? score(a) < score(b) : objects[a].name < objects[b].name;
  });
  return order;
}

std::string BarData(const std::vector<EvaluatedMethod>& methods, double tolerance,
                    const std::vector<int>& order) {
  std::string data = "# place object S low high\n";
  const double step = kGroupWidth / static_cast<double>(methods.size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    data += fmt::format("{}# {}\n", m > 0 ? "\n\n" : "", methods[m].label);
    const EvalRun& run = RunAt(methods[m], tolerance);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Estimate& s = run.metrics.objects[order[i]][ObjectMetric::kSuccesses];
      const double place =
          static_cast<double>(i) - kGroupWidth / 2 + step * (static_cast<double>(m) + 0.5);
      data += fmt::format("{:.4f} {} {:.6g} {:.6g} {:.6g}\n", place,
                          GnuplotQuoted(methods[m].eval.objects[order[i]].name), s.value, s.low,
                          s.high);
    }
  }
  return data;
}

std::string ObjectTics(const std::vector<EvaluatedMethod>& methods, const std::vector<int>& order) {
  if (order.size() > kMostBars)
    return fmt::format("set xtics 0,10,{} nomirror\nset xlabel \"objects, ascending under {}\"\n",
                       order.size(),
                       GnuplotQuoted(methods.back().label)
                           .substr(1, GnuplotQuoted(methods.back().label).size() - 2));
  std::string tics = "set xtics rotate by 45 right nomirror scale 0 (";
  for (std::size_t i = 0; i < order.size(); ++i)
    tics += fmt::format("{}{} {}", i > 0 ? ", " : "",
                        GnuplotQuoted(methods.front().eval.objects[order[i]].name), i);
  return tics + ")\n";
}

std::string PlotLines(const std::vector<EvaluatedMethod>& methods, bool bars) {
  std::string script = "plot ";
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const std::string color = PaletteColor(static_cast<int>(m));
    const std::string title = GnuplotQuoted(methods[m].label);
    if (m > 0) script += ", \\\n  ";
    if (bars)
      script += fmt::format(
          "data index {0} using 1:3 with boxes lc rgb \"{1}\" fs solid 0.85 noborder title {2}, "
          "\\\n"
          "  data index {0} using 1:4:(0):($5-$4) with vectors nohead lw 0.9 lc rgb \"#303030\" "
          "notitle",
          m, color, title);
    else
      script += fmt::format(
          "data index {0} using 1:4:(0):($5-$4) with vectors nohead lw 0.6 lc rgb \"{1}\" notitle, "
          "\\\n"
          "  data index {0} using 1:3 with points pt 7 ps 0.35 lc rgb \"{3}\" title {2}",
          m, PaletteColor(static_cast<int>(m), 0x80), title, color);
  }
  return script + "\n";
}

}  // namespace

void CheckSameObjects(const std::vector<EvaluatedMethod>& methods) {
  const auto& first = methods.front().eval.objects;
  for (const EvaluatedMethod& method : methods) {
    const auto& objects = method.eval.objects;
    bool same = objects.size() == first.size();
    for (std::size_t i = 0; same && i < first.size(); ++i) same = objects[i].name == first[i].name;
    if (!same)
      Fail("{}: expected the same {} objects as {}, found others", method.label, first.size(),
           methods.front().label);
  }
}

const EvalRun& RunAt(const EvaluatedMethod& method, double tolerance) {
  const EvalRun* run = FindRun(method.eval, tolerance);
  if (run == nullptr) {
    std::string found;
    for (const EvalRun& r : method.eval.runs)
      found += fmt::format("{}{}", found.empty() ? "" : ", ", r.tolerance);
    Fail("{}: expected an evaluation at tolerance {} rad, found {}", method.label, tolerance,
         found);
  }
  return *run;
}

Figure BarsFigure(const std::vector<EvaluatedMethod>& methods, double tolerance) {
  CheckSameObjects(methods);
  const std::vector<int> order = SortedObjects(methods, tolerance);
  const bool bars = order.size() <= kMostBars;
  Figure figure;
  figure.width =
      bars ? std::max(12.0, 3.0 + 0.35 * static_cast<double>(order.size() * methods.size()) +
                                0.4 * static_cast<double>(order.size()))
           : 18;
  figure.height = 7.5;
  figure.data = BarData(methods, tolerance, order);
  figure.script = fmt::format(
      "set key outside top center horizontal samplen 1.5\n"
      "set border 3 lw 0.7\nset grid ytics lc rgb \"#D8D8D8\" lw 0.5 lt 1\n"
      "set ytics nomirror out scale 0.5\n"
      "set boxwidth {:.4f}\nset xrange [-0.7:{}]\nset yrange [0:*]\n"
      "set ylabel \"successes per episode at {} rad\"\n",
      0.92 * kGroupWidth / static_cast<double>(methods.size()),
      static_cast<double>(order.size()) - 0.3, tolerance);
  figure.script += ObjectTics(methods, order) + PlotLines(methods, bars) + "reset\n";
  return figure;
}

}  // namespace dexremoe
