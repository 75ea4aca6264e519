#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "eval/label_places.h"
#include "eval/plots.h"
#include "task/object_set.h"

namespace dexremoe {
namespace {

constexpr std::size_t kMostNames = 30;  // objects; beyond that numbers stand alone
constexpr double kMap = 12.5;           // cm, side of the map
constexpr double kMarkerRadius = 0.1;   // cm
constexpr double kLetterWidth = 0.136;  // cm, of a label

// The group of every object, and what each group is called.
struct Groups {
  std::vector<int> of;  // [O]
  std::map<int, std::string> name;
};

Groups GroupObjects(const Embedding& map, const std::string& color) {
  Groups groups;
  for (const EmbeddedObject& object : map.objects) {
    if (color == "cluster") {
      groups.of.push_back(object.cluster);
      groups.name[object.cluster] = fmt::format("cluster {}", object.cluster + 1);
    } else if (color == "expert") {
      groups.of.push_back(object.expert);
      groups.name[object.expert] = fmt::format("mostly expert {}", object.expert + 1);
    } else if (color == "category") {
      groups.of.push_back(CategoryIndex(object.category));
      groups.name[groups.of.back()] = object.category;
    } else {
      Fail("tsne: colour: expected cluster, category or expert, found '{}'", color);
    }
  }
  return groups;
}

// Maps the plane onto kMap x kMap centimetres, both axes by the same factor.
struct Frame {
  double low_x = HUGE_VAL, low_y = HUGE_VAL, scale = 1;

  explicit Frame(const std::vector<double>& position) {
    double high_x = -HUGE_VAL, high_y = -HUGE_VAL;
    for (std::size_t k = 0; k + 1 < position.size(); k += 2) {
      low_x = std::min(low_x, position[k]);
      high_x = std::max(high_x, position[k]);
      low_y = std::min(low_y, position[k + 1]);
      high_y = std::max(high_y, position[k + 1]);
    }
    constexpr double kBorder = 0.8;  // cm, room for labels at the edge
    const double span = std::max({high_x - low_x, high_y - low_y, 1e-12});
    scale = (kMap - 2 * kBorder) / span;
    low_x -= (kMap / scale - (high_x - low_x)) / 2;
    low_y -= (kMap / scale - (high_y - low_y)) / 2;
  }
  double X(double x) const { return scale * (x - low_x); }
  double Y(double y) const { return scale * (y - low_y); }
};

// Block 0: rows; block 1: objects; block 2: labels; block 3: lines from objects to far labels.
std::string EmbeddingData(const Embedding& map, const Groups& groups, const Frame& frame,
                          const std::vector<std::string>& text,
                          const std::vector<PlacedLabel>& labels) {
  std::string data = "# x y group (cm on paper): one line per row\n";
  for (std::size_t row = 0; row < map.row_object.size(); ++row)
    data += fmt::format("{:.4f} {:.4f} {}\n", frame.X(map.position[2 * row]),
                        frame.Y(map.position[2 * row + 1]), groups.of[map.row_object[row]]);
  data += "\n\n# x y group number name: one line per object\n";
  for (std::size_t o = 0; o < map.objects.size(); ++o)
    data +=
        fmt::format("{:.4f} {:.4f} {} {} {}\n", frame.X(map.objects[o].x),
                    frame.Y(map.objects[o].y), groups.of[o], o, GnuplotQuoted(map.objects[o].name));
  data += "\n\n# x y text\n";
  for (std::size_t o = 0; o < labels.size(); ++o)
    data += fmt::format("{:.4f} {:.4f} {}\n", labels[o].x, labels[o].y, GnuplotQuoted(text[o]));
  data += "\n\n# x y dx dy\nNaN NaN NaN NaN\n";
  for (std::size_t o = 0; o < labels.size(); ++o) {
    if (!labels[o].far) continue;
    const double x = frame.X(map.objects[o].x), y = frame.Y(map.objects[o].y);
    data += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f}\n", x, y, labels[o].end_x - x,
                        labels[o].end_y - y);
  }
  return data;
}

std::string PlotLines(const Groups& groups) {
  std::string script = "plot ";
  for (const auto& [group, name] : groups.name)
    script += fmt::format(
        "data index 0 using 1:($3 == {} ? $2 : NaN) with points pt 7 ps 0.22 lc rgb \"{}\" "
        "notitle, "
        "\\\n  ",
        group, PaletteColor(group, 0x90));
  script +=
      "data index 3 using 1:2:3:4 with vectors nohead lw 0.5 lc rgb \"#808080\" notitle, \\\n  ";
  for (const auto& [group, name] : groups.name)
    script += fmt::format(
        "data index 1 using 1:($3 == {0} ? $2 : NaN) with points pt 7 ps 0.85 lc rgb \"#FFFFFF\" "
        "notitle, \\\n  data index 1 using 1:($3 == {0} ? $2 : NaN) with points pt 7 ps 0.62 lc "
        "rgb "
        "\"{1}\" notitle, \\\n  NaN with points pt 7 ps 0.9 lc rgb \"{1}\" title {2}, \\\n  ",
        group, PaletteColor(group), GnuplotQuoted(name));
  return script +
         "data index 2 using 1:2:3 with labels center boxed font \"DejaVu Sans,7\" textcolor rgb "
         "\"#202020\" notitle\n";
}

// Two lines below the map, as a gnuplot string.
std::string CaptionOf(const Embedding& map) {
  return fmt::format(
      "\"t-SNE of gate weights (log ratios): {} rows of {} objects, perplexity {:.3g}, KL {:.3f}\\n"
      "10-neighbour overlap {:.2f}, trustworthiness {:.3f}; {} clusters by k-means, silhouette "
      "{:.2f}\"",
      map.row_object.size(), map.objects.size(), map.perplexity, map.kl, map.neighbour_overlap,
      map.trustworthiness, map.clusters, map.silhouette);
}

std::vector<std::string> LabelTexts(const Embedding& map) {
  std::vector<std::string> text;
  for (std::size_t o = 0; o < map.objects.size(); ++o)
    text.push_back(map.objects.size() <= kMostNames ? fmt::format("{} {}", o, map.objects[o].name)
                                                    : fmt::format("{}", o));
  return text;
}

std::vector<PlacedLabel> PlaceTexts(const Embedding& map, const Frame& frame,
                                    const std::vector<std::string>& text) {
  std::vector<LabelRequest> requests;
  for (std::size_t o = 0; o < map.objects.size(); ++o)
    requests.push_back({frame.X(map.objects[o].x), frame.Y(map.objects[o].y),
                        0.04 + kLetterWidth * static_cast<double>(text[o].size())});
  LabelCanvas canvas{kMap, kMap, 0.27, kMarkerRadius, {}};
  for (std::size_t k = 0; k + 1 < map.position.size(); k += 2)
    canvas.dots.insert(canvas.dots.end(), {frame.X(map.position[k]), frame.Y(map.position[k + 1])});
  return PlaceLabels(requests, canvas);
}

}  // namespace

Figure EmbeddingFigure(const Embedding& map, const std::string& color) {
  const Groups groups = GroupObjects(map, color);
  const Frame frame(map.position);
  const std::vector<std::string> text = LabelTexts(map);
  Figure figure;
  figure.width = kMap + 0.4;
  figure.height = kMap + 1.9;
  figure.data = EmbeddingData(map, groups, frame, text, PlaceTexts(map, frame, text));
  const double bottom = 1.0 / figure.height, top = (1.0 + kMap) / figure.height;
  figure.script = fmt::format(
      "set lmargin at screen {0:.4f}\nset rmargin at screen {1:.4f}\n"
      "set bmargin at screen {2:.4f}\nset tmargin at screen {3:.4f}\n"
      "set xrange [0:{4}]\nset yrange [0:{4}]\nunset tics\nset border 15 lw 0.6 lc rgb "
      "\"#A0A0A0\"\n"
      "set style textbox opaque noborder margins 0.3,0.3 fillcolor rgb \"#50FFFFFF\"\n"
      "set key at screen 0.5,screen {5:.4f} center center horizontal samplen 0.6 maxcols 4\n"
      "set label 1 {6} at screen 0.5,screen {7:.4f} center font \"DejaVu Sans,7.5\" textcolor rgb "
      "\"#404040\"\n",
      0.2 / figure.width, 1 - 0.2 / figure.width, bottom, top, kMap, (top + 1) / 2, CaptionOf(map),
      0.62 * bottom);
  figure.script += PlotLines(groups) + "reset\n";
  return figure;
}

}  // namespace dexremoe
