// The card of figures beside an episode: time, angle to the goal, successes, gate weights.
#pragma once

#include <string>
#include <vector>

#include "render/canvas.h"

namespace dexremoe {

struct PanelData {
  std::string title;
  std::string subtitle;
  double time = 0;       // s
  double angle = 0;      // rad to the goal
  double tolerance = 0;  // rad
  int successes = 0;
  bool just_reached = false;         // a goal was reached a moment ago
  std::vector<std::string> experts;  // names; empty without a gate
  std::vector<float> weights;
};

// In the top right corner; `unit` is the size of a pixel of a 480-line image, pixels.
void DrawPanel(Canvas& canvas, const PanelData& data, double unit);

// All weights as one bar, expert by expert.
void DrawStackedWeights(Canvas& canvas, double x, double y, double width, double height,
                        const std::vector<float>& weights);
// Colour patches with names in one centred line at baseline y.
void DrawLegend(Canvas& canvas, double x_center, double y, const std::vector<std::string>& names,
                double size);

}  // namespace dexremoe
