// Success per object of many methods, in small panels: one per method or one per object.
#include <algorithm>
#include <numeric>

#include "base/check.h"
#include "base/error.h"
#include "base/random.h"
#include "eval/study_plots.h"

namespace dexremoe {
namespace {

constexpr char kOurs[] = "#D55E00", kOther[] = "#0072B2", kFaint[] = "#9FB8C8";

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

// Panels of one size in rows, with room for labels on all sides; cm.
struct Grid {
  std::size_t across, down;
  double panel_width, panel_height, left, bottom, gap_x, gap_y, top;
  double width() const { return left + static_cast<double>(across) * (panel_width + gap_x); }
  double height() const {
    return bottom + top + static_cast<double>(down) * panel_height +
           static_cast<double>(down - 1) * gap_y;
  }
};

std::string GridScript(const Grid& grid) {
  return fmt::format(
      "set multiplot layout {},{} margins {:.4f},{:.4f},{:.4f},{:.4f} spacing {:.4f},{:.4f}\n"
      "unset key\nset border 3 lw 0.7\nset tics nomirror out scale 0.4 font \"DejaVu Sans,7\"\n",
      grid.down, grid.across, grid.left / grid.width(), 1 - grid.gap_x / grid.width(),
      grid.bottom / grid.height(), 1 - grid.top / grid.height(), grid.gap_x / grid.width(),
      grid.gap_y / grid.height());
}

std::string TitleScript(const std::string& title) {
  return fmt::format("set title {} font \"DejaVu Sans,8\" offset 0,-0.9\n", GnuplotQuoted(title));
}

// S and its interval of one block as points over the objects' places, shifted by so much.
std::string PointsScript(std::size_t method, const char* color, const char* shift) {
  return fmt::format(
      "data index {0} using ($1{2}):4:(0):($5-$4) with vectors nohead lw 0.7 lc rgb \"{1}\", \\\n"
      "  data index {0} using ($1{2}):3 with linespoints pt 7 ps 0.3 lw 0.8 lc rgb \"{1}\"",
      method, color, shift);
}

// Method m, the last beside it; labels on the outer sides of the grid alone.
std::string MethodPanel(const std::vector<EvaluatedMethod>& methods, std::size_t m, bool left,
                        bool bottom) {
  const std::size_t last = methods.size() - 1;
  std::string script = TitleScript(methods[m].label);
  script += fmt::format(
      "set xlabel {} font \"DejaVu Sans,7\" offset 0,0.6\nset ylabel {} font \"DejaVu Sans,7\" "
      "offset 1.2,0\nplot ",
      GnuplotQuoted(bottom ? "objects; orange: " + methods[last].label : ""),
      GnuplotQuoted(left ? "successes per episode" : ""));
  if (m < last) script += PointsScript(m, kOther, "-0.1") + ", \\\n  ";
  return script + PointsScript(last, kOurs, "+0.1") + "\n";
}

// A panel that says which methods were not evaluated.
std::string MissingPanel(const std::vector<std::string>& missing) {
  std::string script =
      "unset border\nunset tics\nunset grid\nunset xlabel\nunset ylabel\n" + TitleScript("missing");
  for (std::size_t k = 0; k < missing.size(); ++k)
    script +=
        fmt::format("set label {} {} at graph 0.5,graph {:.3f} center textcolor rgb \"#808080\"\n",
                    k + 1, GnuplotQuoted(missing[k]),
                    0.9 - 0.8 * static_cast<double>(k) / static_cast<double>(missing.size()));
  return script + "plot [0:1] [0:1] NaN\n";
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
  const std::size_t panels = std::max<std::size_t>(1, methods.size() - 1);
  const std::size_t all = panels + (missing.empty() ? 0 : 1);
  const std::size_t across = std::min<std::size_t>(4, all);
  const Grid grid{across, (all + across - 1) / across, 4.0, 2.9, 1.3, 1.2, 0.75, 0.85, 0.7};
  const double highest = HighestInterval(methods, tolerance, objects);
  Figure figure;
  figure.width = grid.width();
  figure.height = grid.height();
  figure.data = PanelData(methods, tolerance, objects);
  figure.script = GridScript(grid);
  figure.script += fmt::format(
      "set grid ytics lc rgb \"#D8D8D8\" lw 0.5 lt 1\nset xrange [0.3:{}.7]\nset yrange "
      "[0:{:.4g}]\n"
      "set xtics format \"\" scale 0\nset ytics {:.4g}\n",
      objects.size(), highest, NiceStep(highest, 5));
  for (std::size_t m = 0; m < panels; ++m)
    figure.script += MethodPanel(methods, m, m % across == 0, m + across >= all);
  if (!missing.empty()) figure.script += MissingPanel(missing);
  figure.script += "unset multiplot\nreset\n";
  return figure;
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
