#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "eval/plots.h"

namespace dexremoe {
namespace {

// What a known column is called and scaled by; unknown ones keep their name.
struct Axis {
  const char* column;
  const char* label;
  double factor;
  bool log;
};
constexpr Axis kAxes[] = {
    {"successes_per_episode", "successes per episode", 1, false},
    {"drop_rate", "episodes that end in a fall", 1, false},
    {"mean_distance", "mean |dp| (cm)", 100, false},
    {"mean_angle", "mean angle to the goal (rad)", 1, false},
    {"return", "return per episode", 1, false},
    {"episode_length", "episode length (steps)", 1, false},
    {"kl", "KL per update (nats)", 1, false},
    {"learning_rate", "learning rate", 1, true},
    {"successes_per_600", "successes per 600 steps", 1, false},
    {"explained_variance", "explained variance", 1, false},
    {"goal_angle", "widest goal (rad)", 1, false},
    {"routing_entropy", "entropy of the routing (nats)", 1, false},
    {"velocity_tolerance", "speeds allowed / the task's", 1, false},
    {"gravity_factor", "gravity / the task's", 1, false},
    {"samples", "samples (millions)", 1e-6, false},
    {"seconds", "minutes of training", 1.0 / 60, false},
};
constexpr std::size_t kDefaultPanels = 8;  // the first of kAxes

Axis AxisOf(const std::string& column) {
  for (const Axis& axis : kAxes)
    if (column == axis.column) return axis;
  return {column.c_str(), column.c_str(), 1, false};
}

// Straight line fitted to the finite values within `half` rows to either side, at its middle row.
// Inside the curve that is the running mean; at the ends it follows the slope instead of lagging.
double LocalFit(const std::vector<double>& y, int i, int half) {
  double n = 0, st = 0, stt = 0, sy = 0, sty = 0;
  const int end = std::min(static_cast<int>(y.size()), i + half + 1);
  for (int j = std::max(0, i - half); j < end; ++j) {
    if (!std::isfinite(y[j])) continue;
    const double t = j - i;
    n += 1;
    st += t;
    stt += t * t;
    sy += y[j];
    sty += t * y[j];
  }
  const double determinant = n * stt - st * st;
  if (n == 0) return NAN;
  return determinant > 0 ? (stt * sy - st * sty) / determinant : sy / n;
}

std::vector<double> Smoothed(const std::vector<double>& y, int half) {
  std::vector<double> out(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) out[i] = LocalFit(y, static_cast<int>(i), half);
  return out;
}

std::vector<std::string> PanelColumns(const std::vector<Curve>& curves,
                                      const std::vector<std::string>& wanted) {
  if (!wanted.empty()) return wanted;
  std::vector<std::string> columns;
  for (std::size_t k = 0; k < kDefaultPanels; ++k)
    if (std::all_of(curves.begin(), curves.end(),
                    [&](const Curve& c) { return c.table.HasColumn(kAxes[k].column); }))
      columns.push_back(kAxes[k].column);
  if (columns.empty())
    Fail("curves: expected a column such as {}, found none; name some", kAxes[0].column);
  return columns;
}

// One block per run: x, then raw and smoothed values of every panel.
std::string CurveData(const std::vector<Curve>& curves, const std::string& x,
                      const std::vector<std::string>& columns, double smooth) {
  std::string data = "# " + x;
  for (const std::string& column : columns) data += " " + column + " " + column + "_smoothed";
  data += "\n";
  for (std::size_t c = 0; c < curves.size(); ++c) {
    data += fmt::format("{}# {}\n", c > 0 ? "\n\n" : "", curves[c].label);
    const double factor = AxisOf(x).factor;
    const std::vector<double> at = curves[c].table.Numbers(x);
    const int half = static_cast<int>(std::lround(smooth * static_cast<double>(at.size()) / 2));
    std::vector<std::vector<double>> raw, smoothed;
    for (const std::string& column : columns) {
      raw.push_back(curves[c].table.Numbers(column));
      for (double& value : raw.back()) value *= AxisOf(column).factor;
      smoothed.push_back(Smoothed(raw.back(), half));
    }
    for (std::size_t i = 0; i < at.size(); ++i) {
      data += fmt::format("{:.8g}", factor * at[i]);
      for (std::size_t p = 0; p < columns.size(); ++p)
        data += fmt::format(" {:.6g} {:.6g}", raw[p][i], smoothed[p][i]);
      data += "\n";
    }
  }
  return data;
}

// Distance of tics, at most `most` of them over all runs' values; 0 where there is but one value.
double TicStep(const std::vector<Curve>& curves, const std::string& column, int most) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Curve& curve : curves)
    for (const double value : curve.table.Numbers(column)) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  const double range = AxisOf(column).factor * (high - low);
  return range > 0 ? NiceStep(range, most) : 0;
}

std::string TicsScript(const char* axis, double step) {
  return step > 0 ? fmt::format("set {}tics {:.6g}\n", axis, step)
                  : fmt::format("set {}tics autofreq\n", axis);
}

// Colours repeat after eight runs; dashes tell the next eight apart.
const char* DashOf(std::size_t run) { return run < 8 ? "" : " dt 2"; }

std::string PanelScript(const std::vector<Curve>& curves, const std::string& column,
                        std::size_t panel) {
  const Axis axis = AxisOf(column);
  const std::size_t runs = curves.size();
  std::string script =
      fmt::format("set title {} offset 0,-0.6\n{} logscale y\nset format y \"{}\"\n",
                  GnuplotQuoted(axis.label), axis.log ? "set" : "unset", axis.log ? "%.0e" : "%g");
  script += TicsScript("y", axis.log ? 0 : TicStep(curves, column, 6)) + "plot ";
  for (std::size_t r = 0; r < runs; ++r)
    script += fmt::format("{}data index {} using 1:{} with lines lw 0.5 lc rgb \"{}\"",
                          r > 0 ? ", \\\n  " : "", r, 2 * panel + 2,
                          PaletteColor(static_cast<int>(r), 0xB0));
  for (std::size_t r = 0; r < runs; ++r)
    script +=
        fmt::format(", \\\n  data index {} using 1:{} with {} lc rgb \"{}\"", r, 2 * panel + 3,
                    curves[r].table.num_rows() == 1 ? "points pt 7 ps 0.4"
                                                    : fmt::format("lines lw 1.6{}", DashOf(r)),
                    PaletteColor(static_cast<int>(r)));
  return script + "\n";
}

// An empty plot over the whole canvas that carries the legend of all panels.
std::string LegendScript(const std::vector<Curve>& curves, std::size_t across) {
  std::string script =
      "unset title\nunset xlabel\nunset border\nunset tics\nunset grid\nunset logscale\n"
      "set margins screen 0,0,0,0\nset lmargin at screen 0\nset rmargin at screen 1\n"
      "set bmargin at screen 0\nset tmargin at screen 1\n"
      "set key at screen 0.5,screen 0.995 center top horizontal samplen 2 width 1";
  script += fmt::format(" maxcols {}\n", across);
  script += "set xrange [0:1]\nset yrange [0:1]\nplot ";
  for (std::size_t r = 0; r < curves.size(); ++r)
    script +=
        fmt::format("{}NaN with lines lw 2.5{} lc rgb \"{}\" title {}", r > 0 ? ", " : "",
                    DashOf(r), PaletteColor(static_cast<int>(r)), GnuplotQuoted(curves[r].label));
  return script + "\n";
}

// Names that fit side by side into so many cm.
std::size_t NamesAcross(const std::vector<Curve>& curves, double width) {
  std::size_t longest = 0;
  for (const Curve& curve : curves) longest = std::max(longest, curve.label.size());
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(width / (1.6 + 0.22 * static_cast<double>(longest))));
}

}  // namespace

Figure CurvesFigure(const std::vector<Curve>& curves, const std::string& x,
                    const std::vector<std::string>& wanted, double smooth) {
  for (const Curve& curve : curves)
    if (curve.table.num_rows() == 0) Fail("curves: {}: expected rows, found none", curve.label);
  const std::vector<std::string> columns = PanelColumns(curves, wanted);
  const std::size_t across = columns.size() <= 4 ? std::min<std::size_t>(columns.size(), 2) : 4;
  const std::size_t down = (columns.size() + across - 1) / across;
  Figure figure;
  figure.width = 6.3 * static_cast<double>(across);
  const std::size_t names = NamesAcross(curves, figure.width);
  const double legend = 0.45 * static_cast<double>((curves.size() + names - 1) / names - 1);  // cm
  figure.height = 4.9 * static_cast<double>(down) + 0.7 + legend;
  figure.data = CurveData(curves, x, columns, smooth);
  const double top = 1 - (1.35 + legend) / figure.height, bottom = 1.0 / figure.height;
  figure.script = fmt::format(
      "set multiplot layout {},{} margins {:.4f},{:.4f},{:.4f},{:.4f} spacing "
      "{:.4f},{:.4f}\n"
      "unset key\nset grid lc rgb \"#D8D8D8\" lw 0.5 lt 1\nset border 3 lw 0.7\nset tics nomirror "
      "out scale 0.5\nset xrange [*:*]\nset yrange [*:*]\nset autoscale\n"
      "set xlabel {} offset 0,0.5\n",
      down, across, 1.25 / figure.width, 1 - 0.35 / figure.width, bottom, top, 1.35 / figure.width,
      1.75 / figure.height, GnuplotQuoted(AxisOf(x).label));
  figure.script += TicsScript("x", TicStep(curves, x, 5));
  for (std::size_t p = 0; p < columns.size(); ++p)
    figure.script += PanelScript(curves, columns[p], p);
  figure.script += LegendScript(curves, names) + "unset multiplot\nreset\n";
  return figure;
}

}  // namespace dexremoe
