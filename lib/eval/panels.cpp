#include "eval/panels.h"

#include <algorithm>

#include "base/error.h"

namespace dexremoe::panels {
namespace {

std::string PairPanel(const Pairs& pairs, std::size_t m, bool left, bool bottom) {
  const std::size_t last = pairs.labels.size() - 1;
  std::string script = TitleScript(pairs.labels[m]);
  script += bottom ? fmt::format("set xlabel {}.\"\\n\".{}", GnuplotQuoted(pairs.x_label),
                                 GnuplotQuoted("orange: " + pairs.labels[last]))
                   : "set xlabel \"\"";
  script += fmt::format(
      " font \"DejaVu Sans,7\" offset 0,0.6\nset ylabel \"{}\" font \"DejaVu Sans,7\" offset "
      "1.2,0\nplot ",
      left ? "successes per episode" : "");
  if (m < last) script += pairs.plot(m, kOther, "-") + ", \\\n  ";
  return script + pairs.plot(last, kOurs, "+") + "\n";
}

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

}  // namespace

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

Figure PairsFigure(const Pairs& pairs) {
  const std::size_t panels = std::max<std::size_t>(1, pairs.labels.size() - 1);
  const std::size_t all = panels + (pairs.missing.empty() ? 0 : 1);
  const std::size_t across = std::min<std::size_t>(4, all);
  const Grid grid{across, (all + across - 1) / across, 4.0, 2.9, 1.3, 1.5, 0.75, 1.0, 0.7};
  Figure figure;
  figure.width = grid.width();
  figure.height = grid.height();
  figure.data = pairs.data;
  figure.script = GridScript(grid) + "set grid ytics lc rgb \"#D8D8D8\" lw 0.5 lt 1\n" + pairs.axes;
  for (std::size_t m = 0; m < panels; ++m)
    figure.script += PairPanel(pairs, m, m % across == 0, m + across >= all);
  if (!pairs.missing.empty()) figure.script += MissingPanel(pairs.missing);
  figure.script += "unset multiplot\nreset\n";
  return figure;
}

}  // namespace dexremoe::panels
