// What is drawn: meshes at poses with materials, a floor, a background.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/pose.h"

namespace dexremoe {

// Colours are sRGB in [0, 1], as one picks them.
struct Material {
  Eigen::Vector3f color = Eigen::Vector3f::Constant(0.6f);
  float gloss = 0.3f;    // 0 matt .. 1 polished
  float opacity = 1.0f;  // below 1: a translucent ghost without shadow
};

namespace palette {
inline const Material kPalm{{0.56f, 0.58f, 0.61f}, 0.30f, 1};
inline const Material kLink{{0.26f, 0.275f, 0.30f}, 0.40f, 1};
inline const Material kTip{{0.80f, 0.81f, 0.82f}, 0.15f, 1};
inline const Material kObject{{0.96f, 0.58f, 0.22f}, 0.35f, 1};
inline const Material kGoal{{0.00f, 0.62f, 0.52f}, 0.50f, 0.55f};
// Categories and experts, in the order of the lists; readable for colour-blind eyes (after Okabe
// and Ito, "Color Universal Design", 2008).
Eigen::Vector3f Distinct(int index);
// Any number of colours of one strength, neighbours far apart on the colour wheel.
Eigen::Vector3f Wheel(int index);
}  // namespace palette

// A mesh of the renderer's, placed: p_W = X_WM * (scale * p_M).
struct Item {
  int mesh = 0;
  Pose X_WM;
  double scale = 1;
  Material material;
};

// A horizontal plane that shows shadows only and fades into the background.
struct Floor {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m, W
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double radius = 0.3;  // m, where it has faded away
};

struct Scene {
  std::vector<Item> items;
  std::optional<Floor> floor;
  // Towards the light in the camera's axes (right, up, to the viewer): the light follows the camera
  // so that pictures of one sheet agree.
  Eigen::Vector3d light = Eigen::Vector3d(-0.5, 0.7, 0.75);
  // Background: sRGB at the top and the bottom edge.
  Eigen::Vector3f top = Eigen::Vector3f(0.985f, 0.988f, 0.992f);
  Eigen::Vector3f bottom = Eigen::Vector3f(0.885f, 0.895f, 0.91f);
};

}  // namespace dexremoe
