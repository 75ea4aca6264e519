#include "geometry/scale.h"

#include <cmath>

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
      .Add("scale.max_closed", &repair.max_closed,
           "a closed mesh with more triangles is remeshed all the same")
      .Range(1000, 100000000);
  options
      .Add("scale.lost_surface", &repair.lost_surface,
           "share of the surface that may vanish before sheets are thickened")
      .Range(0, 1);
}

ObjectMesh MakeObject(const TriMesh& source, const ScaleOptions& options,
                      const std::string& label) {
  // Repair at unit size, whatever the file's units and place.
  const Box3 bounds = BoundsOf(source);
  const double size = bounds.Size().maxCoeff();
  TriMesh unit = source;
  if (std::isfinite(size) && size > 0)
    for (Eigen::Vector3d& v : unit.vertices) v = (v - bounds.Center()) / size;
  RepairResult repaired = MakeClosedShell(unit, options.repair, label);
  ObjectMesh object;
  object.mesh = std::move(repaired.mesh);
  object.repair = std::move(repaired.text);

  // The source decides the size: a remeshed shell may be a voxel larger or smaller.
  const double length = options.length * options.scale;
  object.source_distance = length * repaired.source_distance;
  const Eigen::Vector3d center = MassPropertiesOf(object.mesh).center;
  for (Eigen::Vector3d& v : object.mesh.vertices) v = length * (v - center);
  object.source_to_object.topLeftCorner<3, 3>() *= length / size;
  object.source_to_object.topRightCorner<3, 1>() = -length * (bounds.Center() / size + center);

  const MassProperties properties = MassPropertiesOf(object.mesh);
  object.mass = options.mass;
  object.volume = properties.volume;
  object.inertia = options.mass / properties.volume * properties.inertia;
  return object;
}

}  // namespace dexremoe
