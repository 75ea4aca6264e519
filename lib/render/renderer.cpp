#include "render/renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "render/resolve.h"
#include "render/shaders.h"

namespace dexremoe {

namespace {

TriMesh UnitSquare() {
  TriMesh square;
  square.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  return square;
}

Eigen::Vector3d Linear(const Eigen::Vector3f& srgb) { return srgb.cast<double>().array().pow(2.2); }

Eigen::Matrix4d MatrixOf(const Item& item) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = item.X_WM.q.toRotationMatrix() * item.scale;
  matrix.topRightCorner<3, 1>() = item.X_WM.p;
  return matrix;
}

}  // namespace

void RenderOptions::Register(Options& options) {
  options
      .Add("render.supersample", &supersample, "pictures are drawn this many times larger per side")
      .Range(1, 4);
  options.Add("render.film_supersample", &film_supersample, "the same for films").Range(1, 4);
  options.Add("render.shadow_size", &shadow_size, "texels per side of the shadow map")
      .Range(64, 8192);
}

Renderer::Renderer(const RenderOptions& options)
    : options_(options),
      gl_(context_.gl()),
      depth_(gl_, shaders::kMeshVertex, shaders::kDepthFragment),
      geometry_(gl_, shaders::kMeshVertex, shaders::kGeometryFragment),
      occlusion_(gl_, shaders::kImageVertex, shaders::kOcclusionFragment),
      blur_(gl_, shaders::kImageVertex, shaders::kBlurFragment),
      background_(gl_, shaders::kImageVertex, shaders::kBackgroundFragment),
      surface_(gl_, shaders::kMeshVertex, shaders::SurfaceFragment()) {
  gl_.GenVertexArrays(1, &empty_array_);
  floor_ = std::make_unique<GpuMesh>(gl_, UnitSquare(), 0.1);
  const int side = options_.shadow_size;
  shadow_map_ = std::make_unique<Target>(gl_, TargetKind::kDepthMap, side, side);
}

Renderer::~Renderer() {
  context_.MakeCurrent();
  gl_.DeleteVertexArrays(1, &empty_array_);
}

int Renderer::AddMesh(const TriMesh& mesh, double crease) {
  context_.MakeCurrent();
  meshes_.push_back(std::make_unique<GpuMesh>(gl_, mesh, crease));
  return int(meshes_.size()) - 1;
}

void Renderer::ClearMeshes() {
  context_.MakeCurrent();
  meshes_.clear();
}

Sphere Renderer::Bounds(const Item& item) const {
  DEX_CHECK_LT(item.mesh, int(meshes_.size()));
  const Sphere& bounds = meshes_[item.mesh]->bounds();
  return {item.X_WM * (item.scale * bounds.center), item.scale * bounds.radius};
}

Image Renderer::Draw(const Scene& scene, const Camera& camera, int width, int height) {
  DEX_CHECK_GT(std::min(width, height), 0);
  context_.MakeCurrent();
  PrepareTargets(width, height);
  const Frame frame = MakeFrame(scene, camera, double(width) / height,
                                [this](const Item& item) { return Bounds(item); });
  gl_.Enable(GL_DEPTH_TEST);
  DrawShadowMap(frame);
  DrawGeometry(frame);
  DrawOcclusion(frame);
  DrawSurfaces(frame);
  return ReadImage(width, height);
}

void Renderer::PrepareTargets(int width, int height) {
  if (geometry_map_ && geometry_map_->width() == width && geometry_map_->height() == height) return;
  const int s = options_.supersample;
  GLint limit = 0;
  gl_.GetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (s * std::max(width, height) > limit)
    Fail("image: expected at most {} pixels a side, found {} x {} (times render.supersample {})",
         limit, width, height, s);
  const auto make = [&](TargetKind kind, int scale) {
    return std::make_unique<Target>(gl_, kind, scale * width, scale * height);
  };
  geometry_map_ = make(TargetKind::kFloatImage, 1);
  occlusion_map_ = make(TargetKind::kByteMap, 1);
  blurred_map_ = make(TargetKind::kByteMap, 1);
  image_ = make(TargetKind::kFloatImage, s);
}

void Renderer::DrawMesh(const Program& program, const Frame& frame, const Item& item,
                        const Eigen::Matrix4d& projection,
                        const Eigen::Matrix4d& camera_from_world) const {
  const Eigen::Matrix4d matrix = camera_from_world * MatrixOf(item);
  program.Set("camera_from_mesh", matrix);
  program.Set("normal_matrix", Eigen::Matrix3d(matrix.topLeftCorner<3, 3>() / item.scale));
  program.Set("projection", projection);
  const bool is_floor = frame.floor && &item == &*frame.floor;
  (is_floor ? floor_ : meshes_[item.mesh])->Draw();
}

void Renderer::DrawShadowMap(const Frame& frame) const {
  shadow_map_->Bind();
  gl_.DepthMask(GL_TRUE);
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  gl_.Enable(GL_POLYGON_OFFSET_FILL);
  gl_.PolygonOffset(1.5f, 2.0f);
  depth_.Use();
  const Eigen::Matrix4d light_from_world = frame.light_view * frame.view;
  for (const Item* item : frame.opaque)
    DrawMesh(depth_, frame, *item, frame.light_projection, light_from_world);
  gl_.Disable(GL_POLYGON_OFFSET_FILL);
}

void Renderer::DrawGeometry(const Frame& frame) const {
  geometry_map_->Bind();
  gl_.ClearColor(0, 0, 0, 0);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  geometry_.Use();
  for (const Item* item : frame.opaque)
    DrawMesh(geometry_, frame, *item, frame.projection, frame.view);
  if (frame.floor) DrawMesh(geometry_, frame, *frame.floor, frame.projection, frame.view);
}

void Renderer::DrawOcclusion(const Frame& frame) const {
  gl_.Disable(GL_DEPTH_TEST);
  gl_.BindVertexArray(empty_array_);
  geometry_map_->BindTexture(0);
  occlusion_map_->Bind();
  occlusion_.Use();
  occlusion_.Set("geometry", 0);
  occlusion_.Set("tangent", Eigen::Vector2d(frame.tan_y * frame.aspect, frame.tan_y));
  occlusion_.Set("radius", 1.6 * frame.feature);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  occlusion_map_->BindTexture(1);
  blurred_map_->Bind();
  blur_.Use();
  blur_.Set("geometry", 0);
  blur_.Set("source", 1);
  blur_.Set("radius", 1.6 * frame.feature);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.Enable(GL_DEPTH_TEST);
}

void Renderer::SetMaterial(const Material& material, int mode) const {
  surface_.Set("base", Linear(material.color));
  surface_.Set("gloss", double(material.gloss));
  surface_.Set("opacity", double(material.opacity));
  surface_.Set("mode", mode);
}

void Renderer::DrawSurfaces(const Frame& frame) const {
  image_->Bind();
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl_.DepthMask(GL_FALSE);
  background_.Use();
  background_.Set("top", frame.scene->top.cast<double>().eval());
  background_.Set("bottom", frame.scene->bottom.cast<double>().eval());
  gl_.BindVertexArray(empty_array_);
  gl_.DepthFunc(GL_LEQUAL);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.DepthMask(GL_TRUE);

  shadow_map_->BindTexture(0);
  geometry_map_->BindTexture(1);
  blurred_map_->BindTexture(2);
  surface_.Use();
  surface_.Set("shadow_map", 0);
  surface_.Set("geometry", 1);
  surface_.Set("occlusion_map", 2);
  const Eigen::Matrix4d to_unit =
      (Eigen::Matrix4d() << 0.5, 0, 0, 0.5, 0, 0.5, 0, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0, 1).finished();
  surface_.Set("light_from_camera",
               Eigen::Matrix4d(to_unit * frame.light_projection * frame.light_view));
  surface_.Set("light_extent", frame.light_extent);
  surface_.Set("supersample", double(options_.supersample));
  surface_.Set("light", frame.light);
  surface_.Set("up", Eigen::Vector3d(0, 1, 0));
  surface_.Set("feature", frame.feature);
  for (const Item* item : frame.opaque) {
    SetMaterial(item->material, 0);
    DrawMesh(surface_, frame, *item, frame.projection, frame.view);
  }
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  if (frame.floor) {
    SetMaterial({}, 2);
    surface_.Set("floor_center",
                 Eigen::Vector3d((frame.view * frame.floor->X_WM.p.homogeneous()).head<3>()));
    surface_.Set("floor_radius", frame.floor->scale);
    gl_.DepthMask(GL_FALSE);
    DrawMesh(surface_, frame, *frame.floor, frame.projection, frame.view);
  }
  for (const Item* ghost : frame.ghosts) DrawGhost(frame, *ghost);
  gl_.Disable(GL_BLEND);
}

// The far side faintly, then the nearest surface once: whatever the shape folds, at most two layers
// are seen and the order of triangles does not matter.
void Renderer::DrawGhost(const Frame& frame, const Item& item) const {
  const auto draw = [&] { DrawMesh(surface_, frame, item, frame.projection, frame.view); };
  gl_.Enable(GL_CULL_FACE);
  gl_.Enable(GL_POLYGON_OFFSET_FILL);
  gl_.PolygonOffset(0, -20000);  // well in front of a solid surface at the same place
  gl_.DepthMask(GL_FALSE);
  gl_.CullFace(GL_FRONT);
  Material faint = item.material;
  faint.opacity *= 0.4f;
  SetMaterial(faint, 1);
  draw();
  gl_.CullFace(GL_BACK);
  gl_.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  gl_.DepthMask(GL_TRUE);
  draw();
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.DepthMask(GL_FALSE);
  SetMaterial(item.material, 1);
  draw();
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_POLYGON_OFFSET_FILL);
  gl_.Disable(GL_CULL_FACE);
}

Image Renderer::ReadImage(int width, int height) const {
  std::vector<float> pixels(std::size_t(4) * image_->width() * image_->height());
  gl_.BindFramebuffer(GL_FRAMEBUFFER, image_->framebuffer());
  gl_.ReadPixels(0, 0, image_->width(), image_->height(), GL_RGBA, GL_FLOAT, pixels.data());
  const GLenum error = gl_.GetError();
  if (error != GL_NO_ERROR) Fail("OSMesa: drawing failed with GL error {:#x}", error);
  return Downsample(pixels, width, height, options_.supersample);
}

}  // namespace dexremoe
