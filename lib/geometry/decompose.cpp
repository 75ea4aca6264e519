#include "geometry/decompose.h"

#include <algorithm>

#include "base/error.h"
#include "geometry/cluster.h"
#include "geometry/hull.h"
#include "geometry/repair.h"

namespace dexremoe {
namespace {

// Cutting goes on to more clusters than asked for, so that merging has a choice.
constexpr std::size_t kClustersPerPart = 3;
constexpr std::size_t kFewestClusters = 16;
constexpr std::size_t kMostClusters = 96;
// Clusters whose share of the allowed cost is below this are not worth a cut; joints that cost no
// more are taken back.
constexpr double kNegligible = 0.05;

// Voxels need a surface without openings; several or crossing shells do no harm.
TriMesh Closed(const TriMesh& mesh, const std::string& label) {
  TriMesh welded = Weld(mesh, 1e-6 * BoundsOf(mesh).Size().maxCoeff());
  const Topology topology = TopologyOf(welded);
  const bool usable = topology.open_edges == 0 && topology.flipped_edges == 0 &&
                      MassPropertiesOf(welded).volume > 0;
  return usable ? welded : MakeClosedShell(mesh, {}, label).mesh;
}

// A part that gets this far from the surface, as a share of the diagonal, costs what
// DecomposeOptions::concavity says.
constexpr double kFar = 0.03;

// Always cuts the worst cluster.
std::vector<Cluster> CutApart(const VoxelSolid& solid, const Concavity& concavity,
                              const DecomposeOptions& options) {
  std::vector<int> all(solid.voxels.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  std::vector<Cluster> clusters = {MakeCluster(solid, concavity, std::move(all))};
  const std::size_t most = options.parts == 1 ? 1
                                              : std::clamp(kClustersPerPart * options.parts,
                                                           kFewestClusters, kMostClusters);
  const double allowed = options.volume_error * solid.volume;
  std::vector<Cluster> settled;  // cannot be cut further
  while (!clusters.empty() && clusters.size() + settled.size() < most) {
    double cost = 0;
    for (const auto* list : {&clusters, &settled})
      for (const Cluster& cluster : *list) cost += cluster.Cost();
    if (cost <= allowed) break;
    const auto worst =
        std::max_element(clusters.begin(), clusters.end(),
                         [](const Cluster& a, const Cluster& b) { return a.Cost() < b.Cost(); });
    if (worst->Cost() <= kNegligible * allowed) break;
    std::vector<Cluster> pieces = CutBest(solid, concavity, *worst, options.balance);
    clusters.erase(worst);
    std::vector<Cluster>& target = pieces.size() == 1 ? settled : clusters;
    for (Cluster& piece : pieces) target.push_back(std::move(piece));
  }
  for (Cluster& cluster : settled) clusters.push_back(std::move(cluster));
  return clusters;
}

}  // namespace

void DecomposeOptions::Register(Options& options) {
  options.Add("decompose.parts", &parts, "convex parts, at most").Range(1, 256);
  options.Add("decompose.resolution", &resolution, "voxels in the bounding box")
      .Range(1000, 4000000);
  options
      .Add("decompose.volume_error", &volume_error,
           "excess and concavity at which cutting stops, as a share of the solid")
      .Range(0, 1);
  options
      .Add("decompose.concavity", &concavity,
           "share of the solid's volume that a part 3 % of the diagonal off the surface weighs")
      .Range(0, 1e3);
  options.Add("decompose.hull_vertices", &hull_vertices, "vertices of a part, at most")
      .Range(4, 1024);
  options.Add("decompose.balance", &balance, "weight of unequal halves against concavity in a cut")
      .Range(0, 10);
}

ConvexParts DecomposeConvex(const TriMesh& mesh, const DecomposeOptions& options,
                            const std::string& label) {
  if (mesh.triangles.empty()) Fail("{}: expected a mesh with faces, found none", label);
  const TriMesh closed = Closed(mesh, label);
  const VoxelSolid solid = Voxelise(closed, options.resolution);
  if (!(solid.volume > 0)) Fail("{}: expected a mesh that encloses a volume, found none", label);
  const Concavity concavity(solid, kFar * BoundsOf(closed).Size().norm(),
                            options.concavity * solid.volume);
  std::vector<Cluster> clusters = CutApart(solid, concavity, options);
  MergeClusters(static_cast<std::size_t>(options.parts),
                kNegligible * options.volume_error * solid.volume, solid.spacing, concavity,
                clusters);
  ConvexParts parts;
  for (const Cluster& cluster : clusters) {
    TriMesh hull = ExactHull(solid, cluster);
    auto limited = ConvexHull(hull.vertices, {options.hull_vertices, 0});
    parts.push_back(limited ? std::move(*limited) : std::move(hull));
  }
  return parts;
}

}  // namespace dexremoe
