// The peer of bench_decompose: convex parts by libHACD (Mamou and Ghorbel 2009; Debian's
// libbullet-extras-dev), the predecessor of V-HACD. Prints the processor time it took, s.
#include <HACD/hacdHACD.h>
#include <spdlog/fmt/fmt.h>

#include <ctime>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "geometry/object_files.h"

namespace dexremoe {
namespace {

using Point = HACD::Vec3<HACD::Real>;
using Triangle = HACD::Vec3<long>;

struct HacdOptions {
  std::string mesh, out;
  int parts = 16, hull_vertices = 64;
  double compacity = 0.1, concavity = 100;

  void Register(Options& options) {
    options.Add("mesh", &mesh, "object file made by scale_mesh").Required();
    options.Add("out", &out, "file of the parts to write").Required().NotStored();
    options.Add("parts", &parts, "clusters to stop at").Range(1, 1024);
    options.Add("hull_vertices", &hull_vertices, "most vertices of a hull").Range(4, 1024);
    options.Add("compacity", &compacity, "weight of a cluster's compactness").Range(0, 10);
    options.Add("concavity", &concavity, "largest concavity; the library's scale is 1000")
        .Range(0, 1000);
  }
};

TriMesh HullOf(HACD::HACD& hacd, std::size_t cluster) {
  std::vector<Point> points(hacd.GetNPointsCH(cluster));
  std::vector<Triangle> triangles(hacd.GetNTrianglesCH(cluster));
  hacd.GetCH(cluster, points.data(), triangles.data());
  TriMesh hull;
  for (const Point& p : points) hull.vertices.emplace_back(p.X(), p.Y(), p.Z());
  for (const Triangle& t : triangles)
    hull.triangles.push_back(
        {static_cast<int>(t.X()), static_cast<int>(t.Y()), static_cast<int>(t.Z())});
  return hull;
}

ConvexParts Decompose(const TriMesh& mesh, const HacdOptions& o) {
  std::vector<Point> points;
  std::vector<Triangle> triangles;
  for (const Eigen::Vector3d& v : mesh.vertices) points.emplace_back(v.x(), v.y(), v.z());
  for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
  HACD::HACD hacd;
  hacd.SetPoints(points.data());
  hacd.SetNPoints(points.size());
  hacd.SetTriangles(triangles.data());
  hacd.SetNTriangles(triangles.size());
  hacd.SetNClusters(o.parts);
  hacd.SetNVerticesPerCH(o.hull_vertices);
  hacd.SetCompacityWeight(o.compacity);
  hacd.SetVolumeWeight(0);
  hacd.SetConcavity(o.concavity);
  hacd.SetAddExtraDistPoints(false);
  hacd.SetAddNeighboursDistPoints(false);
  hacd.SetAddFacesPoints(false);
  if (!hacd.Compute()) Fail("{}: libHACD found no parts", o.mesh);
  ConvexParts parts;
  for (std::size_t i = 0; i < hacd.GetNClusters(); ++i) parts.push_back(HullOf(hacd, i));
  return parts;
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("bench_hacd", "Splits an object into convex parts by libHACD.",
                  "bench_hacd --mesh=mesh.h5 --out=parts.h5");
  HacdOptions o;
  o.Register(options);
  return RunTool(options, argc, argv, [&] {
    const ObjectMesh object = ReadObjectMesh(o.mesh);
    const std::clock_t start = std::clock();
    ObjectParts result;
    result.parts = Decompose(object.mesh, o);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    WriteParts(o.out, result, MakeProvenance(options, 0, {o.mesh}));
    fmt::print("{:.3f}\n", seconds);
  });
}
