#include "geometry/scale.h"

#include "base/error.h"

namespace dexremoe {

void ScaleOptions::Register(Options& options) {
  options.Add("scale.length", &length, "longest side after normalising, m").Range(1e-3, 10);
  options.Add("scale.scale", &scale, "factor after normalising").Range(1e-3, 1e3);
  options.Add("scale.mass", &mass, "mass of the object, kg").Range(1e-6, 1e3);
  options
      .Add("scale.resolution", &repair.resolution,
           "voxels along the longest side where a mesh must be remeshed")
      .Range(16, 512);
  options
      .Add("scale.max_triangles", &repair.max_triangles,
           "a remeshed shell with more triangles is made again with fewer voxels")
      .Range(1000, 10000000);
  options
      .Add("scale.lost_surface", &repair.lost_surface,
           "share of the surface that may vanish before sheets are thickened")
      .Range(0, 1);
}

ObjectMesh MakeObject(const TriMesh& source, const ScaleOptions& options,
                      const std::string& label) {
  RepairResult repaired = MakeClosedShell(source, options.repair, label);
  ObjectMesh object;
  object.mesh = std::move(repaired.mesh);
  object.repair = std::move(repaired.text);

  // The source decides the size: a remeshed shell may be a voxel larger or smaller.
  const double factor = options.length * options.scale / BoundsOf(source).Size().maxCoeff();
  const Eigen::Vector3d center = MassPropertiesOf(object.mesh).center;
  for (Eigen::Vector3d& v : object.mesh.vertices) v = factor * (v - center);
  object.source_to_object.topLeftCorner<3, 3>() *= factor;
  object.source_to_object.topRightCorner<3, 1>() = -factor * center;

  const MassProperties properties = MassPropertiesOf(object.mesh);
  object.mass = options.mass;
  object.volume = properties.volume;
  object.inertia = options.mass / properties.volume * properties.inertia;
  return object;
}

}  // namespace dexremoe
