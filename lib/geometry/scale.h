// From a source mesh to an object: one closed shell, sized, centred, with mass properties.
#pragma once

#include <string>

#include "base/options.h"
#include "geometry/mesh.h"
#include "geometry/object_files.h"
#include "geometry/repair.h"

namespace dexremoe {

struct ScaleOptions {
  // NOTE(paper): the paper scales every mesh by 0.8 and does not give the size before; the source
  // meshes are taken to be normalised to a longest side of 0.1 m, so objects are 80 mm long.
  double length = 0.1;  // m
  double scale = 0.8;
  // NOTE(paper): object masses are not given; 80 g is what a printed 80 mm object weighs.
  double mass = 0.08;  // kg
  RepairOptions repair;
  void Register(Options& options);  // section "scale"
};

// `label` names the mesh in errors. name and category are left empty.
ObjectMesh MakeObject(const TriMesh& source, const ScaleOptions& options, const std::string& label);

}  // namespace dexremoe
