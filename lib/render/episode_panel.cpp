#include "render/episode_panel.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "render/scene.h"

namespace dexremoe {
namespace {

constexpr double kPi = 3.14159265358979;

// Sizes in units.
constexpr double kWidth = 184, kMargin = 14, kPad = 12, kRow = 19, kWeightRow = 17, kBar = 5;

// Draws rows from top to bottom.
class Rows {
 public:
  Rows(Canvas& canvas, double x, double y, double unit) : canvas_(canvas), x_(x), y_(y), u_(unit) {}

  void Title(const std::string& title, const std::string& subtitle) {
    TextStyle style{14 * u_, ink::kText, Align::kLeft, true};
    y_ += 13 * u_;
    canvas_.Text(x_, y_, canvas_.fonts().Fit(title, style, Inner()), style);
    style = {10.5 * u_, ink::kFaint};
    y_ += 15 * u_;
    canvas_.Text(x_, y_, canvas_.fonts().Fit(subtitle, style, Inner()), style);
    y_ += 5 * u_;
  }
  void Value(const std::string& name, const std::string& value, const Color& color, bool bold) {
    y_ += kRow * u_;
    canvas_.Text(x_, y_, name, {11.5 * u_, ink::kFaint});
    canvas_.Text(x_ + Inner(), y_, value, {12 * u_, color, Align::kRight, bold});
  }
  // A bar of `share` of the width, with a tick at `tick` when it lies inside.
  void Bar(double share, const Color& color, double tick) {
    y_ += 6 * u_;
    canvas_.Box(x_, y_, Inner(), kBar * u_, ink::kLine, kBar * u_ / 2);
    const double length = std::clamp(share, 0.0, 1.0) * Inner();
    if (length > 0.5) canvas_.Box(x_, y_, length, kBar * u_, color, kBar * u_ / 2);
    if (tick > 0 && tick < 1)
      canvas_.Box(x_ + tick * Inner() - 0.75 * u_, y_ - 2 * u_, 1.5 * u_, (kBar + 4) * u_,
                  ink::kText);
    y_ += kBar * u_;
  }
  void Heading(const std::string& text) {
    y_ += (kRow + 4) * u_;
    canvas_.Text(x_, y_, text, {11.5 * u_, ink::kText, Align::kLeft, true});
  }
  // Name, bar and value in one line.
  void Weight(const std::string& name, float weight, const Color& color) {
    y_ += kWeightRow * u_;
    const TextStyle style{10.5 * u_, ink::kFaint};
    const double bar = 37 * u_, value = 29 * u_, top = y_ - 6.5 * u_;
    const double left = x_ + Inner() - value - bar;
    canvas_.Text(x_, y_, canvas_.fonts().Fit(name, style, Inner() - value - bar - 4 * u_), style);
    canvas_.Box(left, top, bar, kBar * u_, ink::kLine, kBar * u_ / 2);
    const double length = std::clamp(double(weight), 0.0, 1.0) * bar;
    if (length > 0.5) canvas_.Box(left, top, length, kBar * u_, color, kBar * u_ / 2);
    canvas_.Text(x_ + Inner(), y_, fmt::format("{:.2f}", weight),
                 {10.5 * u_, ink::kText, Align::kRight});
  }

 private:
  double Inner() const { return (kWidth - 2 * kPad) * u_; }
  Canvas& canvas_;
  double x_, y_, u_;
};

double PanelHeight(const PanelData& data) {
  const double weights =
      data.weights.empty() ? 0 : kRow + 6 + kWeightRow * double(data.weights.size());
  return 2 * kPad + 33 + 3 * kRow + 11 + weights;
}

}  // namespace

void DrawPanel(Canvas& canvas, const PanelData& data, double unit) {
  const double x = canvas.width() - (kMargin + kWidth) * unit, y = kMargin * unit;
  const double height = PanelHeight(data) * unit;
  canvas.Box(x - unit, y - unit, (kWidth + 2) * unit, height + 2 * unit, ink::kLine, 9 * unit, 0.8);
  canvas.Box(x, y, kWidth * unit, height, ink::kPaper, 8 * unit, 0.9);
  Rows rows(canvas, x + kPad * unit, y + kPad * unit, unit);
  rows.Title(data.title, data.subtitle);
  rows.Value("time", fmt::format("{:.2f} s", data.time), ink::kText, false);
  rows.Value("successes", fmt::format("{}", data.successes),
             data.just_reached ? ink::kGood : ink::kText, true);
  const bool close = data.angle <= data.tolerance;
  rows.Value("angle to goal", fmt::format("{:.2f} rad", data.angle),
             close ? ink::kGood : ink::kText, false);
  rows.Bar(data.angle / kPi, close ? ink::kGood : palette::kObject.color, data.tolerance / kPi);
  if (data.weights.empty()) return;
  rows.Heading("expert weights");
  for (std::size_t e = 0; e < data.weights.size(); ++e)
    rows.Weight(data.experts[e], data.weights[e], palette::Distinct(int(e)));
}

void DrawStackedWeights(Canvas& canvas, double x, double y, double width, double height,
                        const std::vector<float>& weights) {
  double from = 0;
  for (std::size_t e = 0; e < weights.size(); ++e) {
    canvas.Box(x + from * width, y, weights[e] * width, height, palette::Distinct(int(e)));
    from += weights[e];
  }
}

void DrawLegend(Canvas& canvas, double x_center, double y, const std::vector<std::string>& names,
                double size) {
  const TextStyle style{size, ink::kText};
  const double patch = size * 0.8, gap = size * 0.5, space = size * 1.8;
  double width = -space;
  for (const std::string& name : names)
    width += patch + gap + canvas.fonts().Width(name, style) + space;
  double x = x_center - width / 2;
  for (std::size_t e = 0; e < names.size(); ++e) {
    canvas.Box(x, y - patch, patch, patch, palette::Distinct(int(e)), patch * 0.2);
    canvas.Text(x + patch + gap, y, names[e], style);
    x += patch + gap + canvas.fonts().Width(names[e], style) + space;
  }
}

}  // namespace dexremoe
