// Turns any mesh file into an object: closed, sized, centred, with volume and inertia.
#include <cstdio>
#include <filesystem>

#include "base/options.h"
#include "geometry/mesh_io.h"
#include "geometry/object_files.h"
#include "geometry/scale.h"

namespace {

using namespace dexremoe;

void Print(const TriMesh& source, const ObjectMesh& object) {
  const Eigen::Vector3d size = 1e3 * BoundsOf(object.mesh).Size();
  // How far the centre of mass lies from the middle of the bounding box.
  const Eigen::Vector3d shift = -1e3 * BoundsOf(object.mesh).Center();
  const Eigen::Matrix3d& inertia = object.inertia;
  std::printf("name: %s (%s)\n", object.name.c_str(), object.category.c_str());
  std::printf("triangles: %zu (%zu in the file)\n", object.mesh.triangles.size(),
              source.triangles.size());
  std::printf("repair: %s\n", object.repair.c_str());
  std::printf("source distance: %.2f mm (Hausdorff)\n", 1e3 * object.source_distance);
  std::printf("size: %.2f x %.2f x %.2f mm\n", size.x(), size.y(), size.z());
  std::printf("volume: %.4f cm^3\n", 1e6 * object.volume);
  std::printf("mass: %g kg\n", object.mass);
  std::printf("com shift: %.3f %.3f %.3f mm\n", shift.x(), shift.y(), shift.z());
  std::printf("inertia: xx %.4e yy %.4e zz %.4e xy %.2e xz %.2e yz %.2e kg m^2\n", inertia(0, 0),
              inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2));
}

}  // namespace

int main(int argc, char** argv) {
  Options options(
      "scale_mesh",
      "Makes one closed shell of a mesh file, sizes and centres it, and computes volume, "
      "centre of mass and inertia.",
      "scale_mesh --mesh=meshes/builtin/airplane/airliner.ply --out=mesh.h5");
  std::string mesh_path, out, name, category, export_path;
  ScaleOptions scale;
  LoadLimits limits;
  options.Add("mesh", &mesh_path, "mesh file: obj, stl, ply, off, dae, fbx, gltf, glb").Required();
  options.Add("out", &out, "object file to write").Required().NotStored();
  options.Add("name", &name, "object name (default: the file's name)");
  options.Add("category", &category, "object category (default: the file's folder)");
  options.Add("export", &export_path, "also write the mesh as .ply, .obj or .stl").NotStored();
  scale.Register(options);
  limits.Register(options);
  return RunTool(options, argc, argv, [&] {
    const TriMesh source = LoadMesh(mesh_path, limits);
    ObjectMesh object = MakeObject(source, scale, mesh_path);
    const std::filesystem::path path = std::filesystem::absolute(mesh_path);
    object.name = name.empty() ? path.stem().string() : name;
    object.category = category.empty() ? path.parent_path().filename().string() : category;
    if (!export_path.empty()) SaveMesh(export_path, object.mesh);
    WriteObjectMesh(out, object, MakeProvenance(options, 0, {mesh_path}));
    Print(source, object);
  });
}
