// Draws scenes to images: soft shadow, ambient occlusion, translucent goals, gamma-correct edges.
#pragma once

#include <memory>
#include <vector>

#include "base/options.h"
#include "io/png.h"
#include "render/camera.h"
#include "render/context.h"
#include "render/frame.h"
#include "render/gpu_mesh.h"
#include "render/program.h"
#include "render/scene.h"

namespace dexremoe {

struct RenderOptions {
  int supersample = 3;       // images are drawn this many times larger per side, then averaged
  int film_supersample = 2;  // the same for films (their maker copies it over the other)
  int shadow_size = 1536;    // texels per side of the shadow map
  void Register(Options& options);  // section "render"
};

// Not thread-safe; use it in the thread that made it. Equal scenes give equal bytes.
class Renderer {
 public:
  // Throws Error when no OpenGL 3.3 context can be had.
  explicit Renderer(const RenderOptions& options = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Edges that turn by more than `crease` (rad) are drawn sharp. Returns the number for Item::mesh.
  int AddMesh(const TriMesh& mesh, double crease = 0.6);
  // Forgets all meshes, so that long sheets do not fill the memory.
  void ClearMeshes();
  // Bounding sphere of an item in W.
  Sphere Bounds(const Item& item) const;

  // Throws Error when the image is larger than the driver can draw.
  Image Draw(const Scene& scene, const Camera& camera, int width, int height);

  const RenderContext& context() const { return context_; }

 private:
  void PrepareTargets(int width, int height);
  void DrawMesh(const Program& program, const Frame& frame, const Item& item,
                const Eigen::Matrix4d& projection, const Eigen::Matrix4d& camera_from_world) const;
  void DrawShadowMap(const Frame& frame) const;
  void DrawGeometry(const Frame& frame) const;
  void DrawOcclusion(const Frame& frame) const;
  void DrawSurfaces(const Frame& frame) const;
  void DrawGhost(const Frame& frame, const Item& item) const;
  void SetMaterial(const Material& material, int mode) const;
  Image ReadImage(int width, int height) const;

  RenderOptions options_;
  RenderContext context_;
  const Gl& gl_;
  Program depth_, geometry_, occlusion_, blur_, background_, surface_;
  GLuint empty_array_ = 0;  // the full-image triangle has no vertex data
  std::unique_ptr<GpuMesh> floor_;
  std::vector<std::unique_ptr<GpuMesh>> meshes_;
  std::unique_ptr<Target> shadow_map_, geometry_map_, occlusion_map_, blurred_map_, image_;
};

}  // namespace dexremoe
