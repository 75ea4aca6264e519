#include "geometry/repair.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "geometry/distance_field.h"
#include "geometry/remesh.h"

namespace dexremoe {
namespace {

constexpr int kSamples = 4000;        // points that test whether the surface survived
constexpr double kOffsetCells = 0.8;  // thickening, on either side, of sheets that would vanish
constexpr double kPlateCells = 1.75;  // what sheets become: twice that and the rounding of edges
// A closed shell may cross itself at this share of its surface: so do many good models, at joints.
constexpr double kFewCrossings = 0.02;
constexpr int kCrossingSamples = 400;

// Sheets modelled from both sides cancel in the winding number. When most of the mesh is such,
// one side of each is dropped; where a few triangles meet back to back (two solids that touch),
// their cancelling is just right.
TriMesh WithoutDoubleSides(const TriMesh& mesh) {
  std::map<std::array<int, 3>, int> uses;
  const auto key = [](std::array<int, 3> t) {
    std::sort(t.begin(), t.end());
    return t;
  };
  std::size_t doubled = 0;
  for (const auto& t : mesh.triangles) doubled += ++uses[key(t)] == 2;
  if (4 * doubled < mesh.triangles.size()) return mesh;
  TriMesh result;
  result.vertices = mesh.vertices;
  std::set<std::array<int, 3>> seen;
  for (const auto& t : mesh.triangles)
    if (seen.insert(key(t)).second) result.triangles.push_back(t);
  return result;
}

// What became of the shells that were not kept.
struct Dropped {
  int pieces = 0;           // separate solids
  int cavities = 0;         // hollows inside, now filled
  double volume_share = 0;  // of the pieces
};

// The shell of largest volume.
TriMesh LargestShell(const TriMesh& mesh, Dropped& dropped) {
  const std::vector<int> shell = ShellOfTriangles(mesh);
  const int count = shell.empty() ? 0 : *std::max_element(shell.begin(), shell.end()) + 1;
  std::vector<std::vector<int>> members(count);
  for (std::size_t t = 0; t < shell.size(); ++t) members[shell[t]].push_back(static_cast<int>(t));
  double total = 0, largest = 0;
  TriMesh best;
  dropped = {};
  for (const std::vector<int>& triangles : members) {
    TriMesh piece = Submesh(mesh, triangles);
    const double volume = MassPropertiesOf(piece).volume;
    (volume > 0 ? dropped.pieces : dropped.cavities) += 1;
    total += std::max(volume, 0.0);
    if (volume <= largest) continue;
    largest = volume;
    best = std::move(piece);
  }
  dropped.pieces = std::max(dropped.pieces - 1, 0);
  dropped.volume_share = total > 0 ? 1 - largest / total : 0;
  return best;
}

// Fraction of the source surface that lies more than a cell outside the new shell.
double LostSurface(const std::vector<Eigen::Vector3d>& samples, const TriMesh& shell, double cell) {
  if (shell.triangles.empty()) return 1;
  const TriangleBvh bvh(shell);
  int lost = 0;
  for (const Eigen::Vector3d& p : samples)
    lost += bvh.Closest(p).distance > cell && bvh.WindingNumber(p) < 0.5;
  return static_cast<double>(lost) / static_cast<double>(samples.size());
}

// Share of a closed shell's surface that does not have the solid on its inner side and nothing on
// the other.
double CrossingShare(const TriMesh& mesh) {
  const TriangleBvh bvh(mesh);
  const double step = 1e-4 * BoundsOf(mesh).Size().maxCoeff();
  const std::vector<Eigen::Vector3d> samples = SpreadOverSurface(mesh, kCrossingSamples);
  int wrong = 0;
  for (const Eigen::Vector3d& p : samples) {
    const auto& [a, b, c] = mesh.triangles[bvh.Closest(p).triangle];
    const Eigen::Vector3d across = step * (mesh.vertices[b] - mesh.vertices[a])
                                              .cross(mesh.vertices[c] - mesh.vertices[a])
                                              .stableNormalized();
    wrong += std::abs(bvh.WindingNumber(p - across) - 1) > 0.4 ||
             std::abs(bvh.WindingNumber(p + across)) > 0.4;
  }
  return static_cast<double>(wrong) / kCrossingSamples;
}

double SourceDistance(const TriMesh& source, const TriMesh& mesh) {
  const TriangleBvh from(source), to(mesh);
  double most = 0;
  for (const Eigen::Vector3d& p : SpreadOverSurface(mesh, kSamples))
    most = std::max(most, from.Closest(p).distance);
  for (const Eigen::Vector3d& p : SpreadOverSurface(source, kSamples)) {
    const double distance = to.Closest(p).distance;
    if (distance > most && to.WindingNumber(p) < 0.5) most = distance;
  }
  return most;
}

struct Shell {
  TriMesh mesh;
  Dropped dropped;
  double offset_share = 0;  // thickening over the longest side; 0: none
};

Shell ExtractShell(const TriMesh& source, int resolution, double lost_surface) {
  const TriangleBvh bvh(source);
  DistanceGrid grid = GridAround(BoundsOf(source), resolution, 3);
  FillSignedDistance(bvh, grid);
  Shell shell;
  shell.mesh = LargestShell(ExtractLevelSet(grid, 0), shell.dropped);
  const double lost = LostSurface(SpreadOverSurface(source, kSamples), shell.mesh, grid.spacing);
  if (lost > lost_surface) {
    shell.offset_share = kOffsetCells / resolution;
    shell.mesh = LargestShell(ExtractLevelSet(grid, kOffsetCells * grid.spacing), shell.dropped);
  }
  return shell;
}

// The number of triangles goes with the square of the resolution, or a little faster.
int Coarser(int resolution, double too_many) {
  return std::max(16, static_cast<int>(0.97 * resolution / std::sqrt(too_many)));
}

// What keeps to max_triangles, judged by a shell of half the resolution: an eighth of the work.
int FittingResolution(const TriMesh& source, const RepairOptions& options) {
  constexpr double kGrowth = 4.2;  // of the number of triangles
  const Shell coarse =
      ExtractShell(source, std::max(options.resolution / 2, 8), options.lost_surface);
  const double expected = kGrowth * static_cast<double>(coarse.mesh.triangles.size());
  if (expected <= options.max_triangles) return options.resolution;
  return Coarser(options.resolution, expected / options.max_triangles);
}

std::string Describe(const Topology& was, const std::string& fault, const Shell& shell) {
  std::string text = fmt::format("remeshed: {} shells, {} open edges, {} crowded edges{}",
                                 was.shells, was.open_edges, was.crowded_edges, fault);
  if (shell.offset_share > 0)
    text += fmt::format(
        "; thickened, sheets to {:.2g} % of its length at most (they would have vanished)",
        100 * kPlateCells / kOffsetCells * shell.offset_share);
  const Dropped& dropped = shell.dropped;
  if (dropped.cavities > 0) text += fmt::format("; filled {} cavities", dropped.cavities);
  if (dropped.pieces > 0)
    text += fmt::format("; dropped {} separate pieces, {:.2g} % of the volume", dropped.pieces,
                        100 * dropped.volume_share);
  return text;
}

RepairResult Remesh(const TriMesh& mesh, const Topology& was, const std::string& fault,
                    const RepairOptions& options, const std::string& label) {
  const TriMesh source = WithConsistentWinding(WithoutDoubleSides(mesh));
  int resolution = FittingResolution(source, options);
  Shell shell = ExtractShell(source, resolution, options.lost_surface);
  const auto count = static_cast<double>(shell.mesh.triangles.size());
  if (count > options.max_triangles) {
    resolution = Coarser(resolution, count / options.max_triangles);
    shell = ExtractShell(source, resolution, options.lost_surface);
  }
  SmoothTangentially(2, shell.mesh);
  if (!(MassPropertiesOf(shell.mesh).volume > 0))
    Fail("{}: expected a mesh that encloses a volume, found none after remeshing", label);
  return {shell.mesh, Describe(was, fault, shell), SourceDistance(mesh, shell.mesh)};
}

// A closed mesh of one shell as it is, or with its winding mended; without triangles where that
// does not make it a solid.
RepairResult Kept(const TriMesh& welded, const Topology& topology) {
  if (topology.shells != 1) return {};
  if (topology.ClosedManifold()) {
    const double volume = MassPropertiesOf(welded).volume;
    if (volume > 0) return {welded, "closed as it was"};
    if (volume < 0) return {WithConsistentWinding(welded), "closed; turned inside out"};
  }
  if (topology.open_edges == 0 && topology.crowded_edges == 0 && topology.pinched_vertices == 0) {
    const TriMesh turned = WithConsistentWinding(welded);
    if (TopologyOf(turned).ClosedManifold() && MassPropertiesOf(turned).volume > 0)
      return {turned, fmt::format("closed; winding mended at {} edges", topology.flipped_edges)};
  }
  return {};
}

}  // namespace

RepairResult MakeClosedShell(const TriMesh& mesh, const RepairOptions& options,
                             const std::string& label) {
  const double size = BoundsOf(mesh).Size().maxCoeff();
  if (!(size > 0))
    Fail("{}: expected a mesh with an extent, found all vertices at one place", label);
  if (!std::isfinite(size)) Fail("{}: expected a mesh of finite extent, found {}", label, size);
  // 32-bit coordinates of equal points differ by rounding at most.
  const TriMesh welded = Weld(mesh, 1e-6 * size);
  if (SpreadOverSurface(welded, 1).empty())
    Fail("{}: expected faces with an area, found none", label);
  const Topology topology = TopologyOf(welded);
  std::string fault;
  RepairResult kept = Kept(welded, topology);
  if (!kept.mesh.triangles.empty()) {
    if (static_cast<int>(welded.triangles.size()) > options.max_closed)
      fault = fmt::format(", {} triangles", welded.triangles.size());
    else if (CrossingShare(kept.mesh) > kFewCrossings)
      fault = ", crosses itself";
    else
      return kept;
  }
  return Remesh(welded, topology, fault, options, label);
}

}  // namespace dexremoe
