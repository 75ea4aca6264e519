// Meshes as the graphics pipeline wants them: three corners per triangle, each with its normal.
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "render/camera.h"
#include "render/gl.h"

namespace dexremoe {

// Six floats per corner: position (m), unit normal. A corner's normal is the area-weighted mean
// over the triangles at the same point whose faces turn by less than `crease` (rad) against its
// own: edges sharper than that stay crisp. Triangles without area are left out.
std::vector<float> ShadedCorners(const TriMesh& mesh, double crease);

// A mesh on the graphics side. Needs the context it was made in to be current.
class GpuMesh {
 public:
  GpuMesh(const Gl& gl, const TriMesh& mesh, double crease);
  ~GpuMesh();
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;

  void Draw() const;
  const Sphere& bounds() const { return bounds_; }  // in the mesh's frame

 private:
  const Gl& gl_;
  GLuint array_ = 0, buffer_ = 0;
  int corners_ = 0;
  Sphere bounds_;
};

}  // namespace dexremoe
