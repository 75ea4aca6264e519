#include "hand/urdf_geometry.h"

#include <urdf_model/link.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "geometry/decompose.h"
#include "geometry/hull.h"
#include "geometry/mesh_io.h"
#include "geometry/repair.h"
#include "hand/primitive_mesh.h"

namespace dexremoe::internal {
namespace {

namespace fs = std::filesystem;

constexpr int kHullVertices = 32;
constexpr double kNearlyConvex = 0.8;  // of the hull's volume
constexpr int kLinkParts = 4;
constexpr int kLinkVoxels = 10000;
constexpr double kWeld = 1e-6;  // m; STL files repeat vertices, rounded differently
constexpr char kCapsuleEnding[] = "_capsule";

bool EndsWith(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

// Where a mesh named in the URDF lies: relative to the URDF's folder (or one of the two above it
// for package:// names), else a file of that name beside the URDF or in a folder `meshes` there.
std::string FindMesh(const std::string& urdf_path, const std::string& link, std::string name) {
  const std::string as_written = name;
  for (const std::string prefix : {"file://", "model://", "package://"})
    if (name.starts_with(prefix)) {
      name.erase(0, prefix.size());
      if (prefix != "file://") name.erase(0, name.find('/') + 1);  // the package's name
    }
  const fs::path folder = fs::path(urdf_path).parent_path();
  const fs::path base = fs::path(name).filename();
  for (const fs::path& candidate :
       {folder / name, folder / ".." / name, folder / ".." / ".." / name, folder / base,
        folder / "meshes" / base, folder / ".." / "meshes" / base}) {
    if (fs::is_regular_file(candidate)) return candidate.lexically_normal().string();
  }
  Fail("{}: link '{}': mesh: expected a file '{}' relative to the URDF, found none", urdf_path,
       link, as_written);
}

struct Context {
  const std::string& urdf_path;
  const std::string& link;
};

double Positive(const Context& context, const char* what, double value) {
  if (!(value > 0) || !std::isfinite(value))
    Fail("{}: link '{}': {}: expected a positive number, found {}", context.urdf_path, context.link,
         what, value);
  return value;
}

Eigen::Vector3d BoxSize(const Context& context, const urdf::Geometry& geometry) {
  const auto& dim = static_cast<const urdf::Box&>(geometry).dim;
  return {Positive(context, "box size", dim.x), Positive(context, "box size", dim.y),
          Positive(context, "box size", dim.z)};
}

TriMesh FileMesh(const Context& context, const urdf::Geometry& geometry) {
  const auto& source = static_cast<const urdf::Mesh&>(geometry);
  const std::string path = FindMesh(context.urdf_path, context.link, source.filename);
  TriMesh mesh = LoadMesh(path);
  const Eigen::Vector3d scale(Positive(context, "mesh scale", source.scale.x),
                              Positive(context, "mesh scale", source.scale.y),
                              Positive(context, "mesh scale", source.scale.z));
  for (Eigen::Vector3d& p : mesh.vertices) p = p.cwiseProduct(scale);
  return mesh;
}

// The surface of any URDF shape about its own origin.
TriMesh MeshOf(const Context& context, const urdf::Geometry& geometry, bool capsule) {
  switch (geometry.type) {
    case urdf::Geometry::SPHERE:
      return SphereMesh(
          Positive(context, "radius", static_cast<const urdf::Sphere&>(geometry).radius));
    case urdf::Geometry::BOX:
      return BoxMesh(BoxSize(context, geometry));
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      return CylinderMesh(Positive(context, "radius", cylinder.radius),
                          Positive(context, "length", cylinder.length), capsule);
    }
    case urdf::Geometry::MESH:
      return FileMesh(context, geometry);
  }
  Fail("{}: link '{}': geometry: expected sphere, box, cylinder or mesh", context.urdf_path,
       context.link);
}

// NOTE(paper): the paper decomposes the hand's links like the objects (V-HACD). Here a link that
// nearly fills its hull stays one part, for every part costs time in each step.
ConvexParts ConvexPartsOf(const Context& context, const TriMesh& mesh) {
  const auto hull = ConvexHull(mesh.vertices, {.max_vertices = kHullVertices});
  if (!hull)
    Fail(
        "{}: link '{}': collision mesh: expected a body with a volume, found {} vertices in a "
        "plane",
        context.urdf_path, context.link, mesh.vertices.size());
  const double filled = MassPropertiesOf(mesh).volume / MassPropertiesOf(*hull).volume;
  if (filled > kNearlyConvex) return {*hull};
  DecomposeOptions options;
  options.parts = kLinkParts;
  options.resolution = kLinkVoxels;
  options.hull_vertices = kHullVertices;
  return DecomposeConvex(Weld(mesh, kWeld), options,
                         fmt::format("{}: link '{}'", context.urdf_path, context.link));
}

}  // namespace

Pose PoseOf(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized(),
          Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z)};
}

void AppendColliders(const std::string& urdf_path, const urdf::Link& source, int link,
                     const Pose& X_LB, bool fingertip, std::vector<Collider>& colliders) {
  const Context context{urdf_path, source.name};
  int number = 0;
  for (const auto& collision : source.collision_array) {
    Collider collider;
    collider.name =
        collision->name.empty() ? fmt::format("{}_{}", source.name, number) : collision->name;
    collider.link = link;
    collider.X_LC = X_LB * PoseOf(collision->origin);
    collider.fingertip = fingertip;
    ++number;
    const urdf::Geometry& geometry = *collision->geometry;
    if (geometry.type == urdf::Geometry::SPHERE) {
      collider.shape = ColliderShape::kSphere;
      collider.radius =
          Positive(context, "radius", static_cast<const urdf::Sphere&>(geometry).radius);
    } else if (geometry.type == urdf::Geometry::BOX) {
      collider.shape = ColliderShape::kBox;
      collider.half_size = BoxSize(context, geometry) / 2;
    } else if (geometry.type == urdf::Geometry::CYLINDER &&
               EndsWith(collider.name, kCapsuleEnding)) {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      collider.shape = ColliderShape::kCapsule;
      collider.radius = Positive(context, "radius", cylinder.radius);
      collider.half_length = Positive(context, "length", cylinder.length) / 2;
    } else {
      collider.shape = ColliderShape::kHull;
      const ConvexParts parts = ConvexPartsOf(context, MeshOf(context, geometry, false));
      for (std::size_t k = 0; k < parts.size(); ++k) {
        Collider part = collider;
        if (parts.size() > 1) part.name += fmt::format("_part_{}", k);
        part.hull = parts[k];
        colliders.push_back(std::move(part));
      }
      continue;
    }
    colliders.push_back(std::move(collider));
  }
}

void AppendVisuals(const std::string& urdf_path, const urdf::Link& source, const Pose& X_LB,
                   Link& target) {
  const Context context{urdf_path, source.name};
  for (const auto& visual : source.visual_array) {
    const Pose X_LV = X_LB * PoseOf(visual->origin);
    Append(MeshOf(context, *visual->geometry, EndsWith(visual->name, kCapsuleEnding)), X_LV,
           target.visual);
    Eigen::Vector3f color(0.7f, 0.7f, 0.7f);
    if (visual->material)
      color = {visual->material->color.r, visual->material->color.g, visual->material->color.b};
    target.visual_color.resize(target.visual.vertices.size(), color);
  }
}

}  // namespace dexremoe::internal
