// Success per object of many methods, in small panels: one per method or one per object.
#include <algorithm>
#include <numeric>

#include "base/check.h"
#include "base/error.h"
#include "base/random.h"
#include "eval/panels.h"
#include "eval/study_plots.h"

namespace dexremoe {
namespace {

using namespace panels;

const Estimate& SuccessesOf(const EvaluatedMethod& method, double tolerance, int object) {
  return RunAt(method, tolerance).metrics.objects[object][ObjectMetric::kSuccesses];
}

std::vector<int> ObjectsOfSplit(const EvalFile& eval, bool train) {
  std::vector<int> objects;
  for (std::size_t o = 0; o < eval.objects.size(); ++o)
    if ((eval.objects[o].split == "train") == train) objects.push_back(static_cast<int>(o));
  return objects;
}

// Ascending by S averaged over methods first .. last - 1; ties by name.
void SortBySuccess(const std::vector<EvaluatedMethod>& methods, double tolerance, std::size_t first,
                   std::size_t last, std::vector<int>& objects) {
  const auto score = [&](int o) {
    double sum = 0;
    for (std::size_t m = first; m < last; ++m) sum += SuccessesOf(methods[m], tolerance, o).value;
    return sum;
  };
  const auto& names = methods.front().eval.objects;
  std::sort(objects.begin(), objects.end(), [&](int a, int b) {
    return score(a) != score(b) ? score(a) < score(b) : names[a].name < names[b].name;
  });
}

// One block per method: place, name, S, low, high of every object in this order.
std::string PanelData(const std::vector<EvaluatedMethod>& methods, double tolerance,
                      const std::vector<int>& objects) {
  std::string data = "# place object S low high\n";
  for (std::size_t m = 0; m < methods.size(); ++m) {
    data += fmt::format("{}# {}\n", m > 0 ? "\n\n" : "", methods[m].label);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const Estimate& s = SuccessesOf(methods[m], tolerance, objects[i]);
      data += fmt::format("{} {} {:.6g} {:.6g} {:.6g}\n", i + 1,
                          GnuplotQuoted(methods[m].eval.objects[objects[i]].name), s.value, s.low,
                          s.high);
    }
  }
  return data;
}

double HighestInterval(const std::vector<EvaluatedMethod>& methods, double tolerance,
                       const std::vector<int>& objects) {
  double highest = 1e-3;
  for (const EvaluatedMethod& method : methods)
    for (const int o : objects) highest = std::max(highest, SuccessesOf(method, tolerance, o).high);
  return 1.04 * highest;
}

// The rows' names on the left-most panels; the last, ours, on top.
std::string MethodTics(const std::vector<EvaluatedMethod>& methods,
                       const std::vector<std::string>& missing, bool named) {
  const std::size_t rows = methods.size() + missing.size();
  std::string tics = "set ytics scale 0 (";
  for (std::size_t r = 0; r < rows; ++r) {
    const std::string name =
        r < methods.size() ? methods[r].label : missing[r - methods.size()] + " (missing)";
    tics += fmt::format("{}{} {}", r > 0 ? ", " : "", named ? GnuplotQuoted(name) : "\"\"", r);
  }
  return tics + ")\n";
}

std::string ObjectPanel(const std::vector<EvaluatedMethod>& methods, std::size_t place) {
  std::string script = "plot ";
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const bool ours = m + 1 == methods.size();
    script += fmt::format(
        "{0}data index {1} every ::{2}::{2} using ($3/2):({1}):($3/2):(0.36) with boxxyerror fs "
        "solid noborder lc rgb \"{3}\", \\\n"
        "  data index {1} every ::{2}::{2} using 4:({1}):($5-$4):(0) with vectors nohead lw 1 lc "
        "rgb \"#303030\"",
        m > 0 ? ", \\\n  " : "", m, place, ours ? kOurs : kFaint);
  }
  return script + "\n";
}

}  // namespace

Figure SortedFigure(const std::vector<EvaluatedMethod>& methods, double tolerance,
                    const std::vector<std::string>& missing) {
  CheckSameObjects(methods);
  std::vector<int> objects = ObjectsOfSplit(methods.back().eval, true);
  if (objects.empty()) Fail("{}: expected training objects, found none", methods.back().label);
  SortBySuccess(methods, tolerance, methods.size() - 1, methods.size(), objects);
  const double highest = HighestInterval(methods, tolerance, objects);
  Pairs pairs;
  for (const EvaluatedMethod& method : methods) pairs.labels.push_back(method.label);
  pairs.missing = missing;
  pairs.data = PanelData(methods, tolerance, objects);
  pairs.x_label = "training objects";
  pairs.axes = fmt::format(
      "set xrange [0.3:{}.7]\nset yrange [0:{:.4g}]\nset xtics format \"\" scale 0\n"
      "set ytics {:.4g}\n",
      objects.size(), highest, NiceStep(highest, 5));
  pairs.plot = [](std::size_t method, const char* color, const char* side) {
    return fmt::format(
        "data index {0} using ($1{2}0.1):4:(0):($5-$4) with vectors nohead lw 0.7 lc rgb \"{1}\", "
        "\\\n  data index {0} using ($1{2}0.1):3 with linespoints pt 7 ps 0.3 lw 0.8 lc rgb "
        "\"{1}\"",
        method, color, side);
  };
  return PairsFigure(pairs);
}

Figure ObjectPanelsFigure(const std::vector<EvaluatedMethod>& methods, double tolerance,
                          const std::vector<int>& objects,
                          const std::vector<std::string>& missing) {
  CheckSameObjects(methods);
  DEX_CHECK(!objects.empty());
  const std::size_t rows = methods.size() + missing.size();
  const std::size_t across = std::min<std::size_t>(5, objects.size());
  Grid grid{across, (objects.size() + across - 1) / across, 2.9, 0, 2.9, 1.0, 0.3, 1.3, 0.7};
  grid.panel_height = 0.34 * static_cast<double>(rows) + 0.3;
  const double highest = HighestInterval(methods, tolerance, objects);
  Figure figure;
  figure.width = grid.width();
  figure.height = grid.height();
  figure.data = PanelData(methods, tolerance, objects);
  figure.script = GridScript(grid);
  figure.script += fmt::format(
      "set grid xtics lc rgb \"#D8D8D8\" lw 0.5 lt 1\nset xrange [0:{:.4g}]\nset yrange "
      "[-0.7:{}.7]\n"
      "set xtics {:.4g}\nset xlabel \"successes per episode\" font \"DejaVu Sans,7\" offset "
      "0,0.6\n",
      highest, rows - 1, NiceStep(highest, 4));
  for (std::size_t i = 0; i < objects.size(); ++i)
    figure.script += TitleScript(methods.front().eval.objects[objects[i]].name) +
                     MethodTics(methods, missing, i % across == 0) + ObjectPanel(methods, i);
  figure.script += "unset multiplot\nreset\n";
  return figure;
}

std::vector<int> HardestObjects(const std::vector<EvaluatedMethod>& methods, double tolerance,
                                int count) {
  CheckSameObjects(methods);
  std::vector<int> objects = ObjectsOfSplit(methods.front().eval, true);
  if (objects.empty()) Fail("{}: expected training objects, found none", methods.front().label);
  SortBySuccess(methods, tolerance, 0, std::max<std::size_t>(1, methods.size() - 1), objects);
  objects.resize(std::min<std::size_t>(objects.size(), static_cast<std::size_t>(count)));
  return objects;
}

std::vector<int> RandomOtherObjects(const std::vector<EvaluatedMethod>& methods, double tolerance,
                                    int count, std::uint64_t seed) {
  CheckSameObjects(methods);
  std::vector<int> objects = ObjectsOfSplit(methods.front().eval, false);
  if (objects.empty())
    Fail("{}: expected objects out of distribution, found none", methods.front().label);
  Rng rng(seed, Stream::kSplit, {objects.size()});
  const std::size_t chosen = std::min<std::size_t>(objects.size(), static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < chosen; ++i)
    std::swap(objects[i], objects[i + rng.Index(objects.size() - i)]);
  objects.resize(chosen);
  SortBySuccess(methods, tolerance, methods.size() - 1, methods.size(), objects);
  return objects;
}

}  // namespace dexremoe
