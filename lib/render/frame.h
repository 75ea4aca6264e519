// What the passes of one image share: matrices, the order of items, the size of soft things.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "render/camera.h"
#include "render/scene.h"

namespace dexremoe {

struct Frame {
  const Scene* scene = nullptr;
  double aspect = 1, tan_y = 1;                  // width / height; tan of half the vertical angle
  Eigen::Matrix4d view, projection;              // W -> camera -> clip
  Eigen::Matrix4d light_view, light_projection;  // camera -> light -> clip
  Eigen::Vector3d light;                         // towards it, camera axes
  double light_extent = 0;                       // side of the cube that the light sees; m
  std::vector<const Item*> opaque, ghosts;       // ghosts from far to near
  std::optional<Item> floor;                     // the square [-1, 1]^2 of z = 0, placed
  double feature = 0;                            // m, the size of soft edges and of occlusion
};

// `bounds` gives an item's bounding sphere in W. The scene must outlive the frame.
Frame MakeFrame(const Scene& scene, const Camera& camera, double aspect,
                const std::function<Sphere(const Item&)>& bounds);

}  // namespace dexremoe
