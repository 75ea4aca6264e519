// The descriptor of one object's shape: 100 numbers, and which category it looks like.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "base/options.h"
#include "shape/cloud.h"
#include "shape/shape_files.h"

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("describe_shape", "Describes a point cloud by the trained shape network.",
                  "describe_shape --net=shape_net.h5 --cloud=cloud.h5 --out=shape.h5");
  std::string net_path, cloud_path, out;
  options.Add("net", &net_path, "trained network (shape_net.h5)").Required();
  options.Add("cloud", &cloud_path, "the object's cloud (cloud.h5)").Required();
  options.Add("out", &out, "descriptor to write (shape.h5)").Required().NotStored();
  return RunTool(options, argc, argv, [&] {
    const ShapeNet net = ReadShapeNet(net_path);
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& p : ReadCloud(cloud_path).points) points.push_back(p.cast<float>());
    const ShapeDescriptor descriptor = DescribeShape(net, points);
    WriteShape(out, descriptor, MakeProvenance(options, 0, {net_path, cloud_path}));
    std::printf("%s: %s\n", cloud_path.c_str(), LikelyCategories(descriptor).c_str());
  });
}
