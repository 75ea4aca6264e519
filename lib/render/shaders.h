// The shading language sources of the renderer's passes. All lighting is in camera axes and in
// linear light.
#pragma once

#include <string>

namespace dexremoe::shaders {

// Position and normal to camera axes; used by every pass that draws meshes.
extern const char kMeshVertex[];
// One triangle over the whole image.
extern const char kImageVertex[];
// Shadow map: depth only.
extern const char kDepthFragment[];
// Normal and depth per pixel, for the ambient occlusion.
extern const char kGeometryFragment[];
// Ambient occlusion from the normals and depths, and the blur that removes its pattern.
extern const char kOcclusionFragment[];
extern const char kBlurFragment[];
// Vertical gradient.
extern const char kBackgroundFragment[];
// Light, shadow, occlusion; opaque, translucent and floor.
std::string SurfaceFragment();

}  // namespace dexremoe::shaders
