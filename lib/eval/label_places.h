// Places for labels beside their points, so that no label hides another or a marker.
#pragma once

#include <vector>

namespace dexremoe {

struct LabelRequest {
  double x = 0, y = 0;  // the point
  double width = 0;     // of the text
};

struct PlacedLabel {
  double x = 0, y = 0;          // middle of the text
  double end_x = 0, end_y = 0;  // where a line from the point meets the text's box
  bool far = false;             // the text is not beside its point: draw that line
};

struct LabelCanvas {
  double width = 0, height = 0;
  double text_height = 0;
  double marker_radius = 0;  // of the labelled points
  std::vector<double> dots;  // x, y of small points better left free
};

// All lengths in the same unit (centimetres on paper). Greedy: each label takes the place nearest
// to its point that hides no marker and no earlier label, stays on the canvas and covers few dots.
std::vector<PlacedLabel> PlaceLabels(const std::vector<LabelRequest>& requests,
                                     const LabelCanvas& canvas);

}  // namespace dexremoe
