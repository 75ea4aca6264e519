// Prints what a mesh file, mesh.h5, parts.h5 or cloud.h5 holds.
#include "shape/mesh_info.h"

#include <cstdio>

#include "base/options.h"

int main(int argc, char** argv) {
  std::string file;
  dexremoe::Options options(
      "mesh_info",
      "Prints counts, bounding box, area, volume, shells and open edges of a mesh file (obj, stl, "
      "ply, off, dae, fbx, gltf, glb) or of mesh.h5, parts.h5 or cloud.h5.",
      "mesh_info --file=meshes/builtin/airplane/biplane.ply");
  options.Add("file", &file, "file to look into").Required();
  return dexremoe::RunTool(options, argc, argv,
                           [&] { std::fputs(dexremoe::DescribeMeshFile(file).c_str(), stdout); });
}
