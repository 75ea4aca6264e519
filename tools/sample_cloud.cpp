// A point cloud of an object's surface.
#include <cstdint>
#include <string>

#include "base/log.h"
#include "base/options.h"
#include "geometry/object_files.h"
#include "shape/cloud.h"

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("sample_cloud",
                  "Samples an object's surface evenly and thins it to farthest points.",
                  "sample_cloud --mesh=mesh.h5 --out=cloud.h5 --export=cloud.ply");
  std::string mesh, out, exported;
  std::uint64_t seed = 0;
  CloudOptions cloud_options;
  options.Add("mesh", &mesh, "object (mesh.h5)").Required();
  options.Add("out", &out, "cloud to write (cloud.h5; metres, frame O)").Required().NotStored();
  options.Add("export", &exported, "also write this .pcd or .ply file").NotStored();
  options.Add("seed", &seed, "random seed");
  cloud_options.Register(options);
  return RunTool(options, argc, argv, [&] {
    const ObjectMesh object = ReadObjectMesh(mesh);
    const PointCloud cloud = SampleCloud(object.mesh, cloud_options, seed);
    if (!exported.empty()) ExportCloud(exported, cloud);
    WriteCloud(out, cloud, MakeProvenance(options, seed, {mesh}));
    LogInfo("{}: {} points of {}", out, cloud.points.size(), object.name);
  });
}
