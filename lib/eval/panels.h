// Figures of many small panels. Internal to the plots.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "eval/figure.h"

namespace dexremoe::panels {

inline constexpr char kOurs[] = "#D55E00", kOther[] = "#0072B2", kFaint[] = "#9FB8C8";

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
// Starts the multiplot; the caller ends it.
std::string GridScript(const Grid& grid);
std::string TitleScript(const std::string& title);

// A panel for every label but the last, which each shows beside its own (for the last where it is
// alone), and one that names those that are missing.
struct Pairs {
  std::vector<std::string> labels, missing;
  std::string data;     // of the figure
  std::string axes;     // gnuplot commands: ranges, tics
  std::string x_label;  // below the last panel of every column
  // What to plot of a label's data: its index, a colour, and "+" or "-" where the last or another
  // may step aside.
  std::function<std::string(std::size_t label, const char* color, const char* side)> plot;
};
Figure PairsFigure(const Pairs& pairs);

}  // namespace dexremoe::panels
