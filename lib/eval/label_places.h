// Places for labels beside their points, so that no label hides another or a marker.
#pragma once

#include <string>
#include <vector>

namespace dexremoe {

struct PlacedLabel {
  double x = 0, y = 0;  // middle of the text
};

// Points and text sizes in the same unit (centimetres on paper). Greedy: the labels are placed in
// turn at the free candidate nearest to their point; crowded ones move further out.
std::vector<PlacedLabel> PlaceLabels(const std::vector<double>& x, const std::vector<double>& y,
                                     const std::vector<double>& text_width, double text_height,
                                     double marker_radius, double width, double height);

}  // namespace dexremoe
