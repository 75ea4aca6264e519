#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>

#include "geometry/repair.h"

namespace dexremoe {
namespace {

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t h = 0;
    for (const std::int64_t c : cell)
      h = (h ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u + (h >> 29);
    return h;
  }
};

// Finds an earlier vertex within the tolerance, or takes the new one in.
class VertexPool {
 public:
  explicit VertexPool(double tolerance) : tolerance_(tolerance) {}

  int Add(const Eigen::Vector3d& p) {
    const Cell cell = CellOf(p);
    const int reach = tolerance_ > 0 ? 1 : 0;
    for (int dx = -reach; dx <= reach; ++dx)
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dz = -reach; dz <= reach; ++dz) {
          const auto found = cells_.find({cell[0] + dx, cell[1] + dy, cell[2] + dz});
          if (found == cells_.end()) continue;
          for (const int i : found->second)
            if ((vertices_[i] - p).norm() <= tolerance_) return i;
        }
    vertices_.push_back(p);
    cells_[cell].push_back(static_cast<int>(vertices_.size()) - 1);
    return static_cast<int>(vertices_.size()) - 1;
  }
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }

 private:
  Cell CellOf(const Eigen::Vector3d& p) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) {
      const double x = p[k] + 0.0;  // -0 and 0 are one position
      cell[k] = tolerance_ > 0 ? static_cast<std::int64_t>(std::floor(x / tolerance_))
                               : static_cast<std::int64_t>(std::hash<double>()(x));
    }
    return cell;
  }
  double tolerance_;
  std::vector<Eigen::Vector3d> vertices_;
  std::unordered_map<Cell, std::vector<int>, CellHash> cells_;
};

// A half-edge of a triangle under its undirected key.
struct HalfEdge {
  int low, high;
  int triangle;
  bool forward;  // runs from low to high
};

std::vector<HalfEdge> SortedHalfEdges(const TriMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
    }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& x, const HalfEdge& y) {
    return std::tie(x.low, x.high, x.triangle) < std::tie(y.low, y.high, y.triangle);
  });
  return edges;
}

// Calls body(first, last) for each group of half-edges on one undirected edge.
template <typename Body>
void ForEachEdge(const std::vector<HalfEdge>& edges, const Body& body) {
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i + 1;
    while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high) ++j;
    body(&edges[i], &edges[i] + (j - i));
    i = j;
  }
}

int Root(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Vertices whose triangles, joined through edges at the vertex, form more than one fan.
int CountPinched(const TriMesh& mesh) {
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int v : mesh.triangles[t]) around[v].push_back(static_cast<int>(t));
  int pinched = 0;
  for (std::size_t v = 0; v < around.size(); ++v) {
    const auto& fan = around[v];
    if (fan.empty()) continue;
    std::vector<int> parent(fan.size());
    std::iota(parent.begin(), parent.end(), 0);
    std::unordered_map<int, int> spoke;  // other end of an edge at v -> place in the fan
    int groups = static_cast<int>(fan.size());
    for (int i = 0; i < static_cast<int>(fan.size()); ++i)
      for (const int other : mesh.triangles[fan[i]]) {
        if (other == static_cast<int>(v)) continue;
        const auto [seen, fresh] = spoke.emplace(other, i);
        const int a = Root(parent, seen->second), b = Root(parent, i);
        if (fresh || a == b) continue;
        parent[a] = b;
        --groups;
      }
    pinched += groups > 1;
  }
  return pinched;
}

}  // namespace

TriMesh Weld(const TriMesh& mesh, double tolerance) {
  VertexPool pool(tolerance);
  std::vector<int> merged(mesh.vertices.size());
  for (std::size_t i = 0; i < merged.size(); ++i) merged[i] = pool.Add(mesh.vertices[i]);

  TriMesh result;
  std::vector<int> renumbered(pool.vertices().size(), -1);
  std::set<std::array<int, 3>> seen;
  for (const auto& triangle : mesh.triangles) {
    std::array<int, 3> t;
    for (int k = 0; k < 3; ++k) t[k] = merged[triangle[k]];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    std::array<int, 3> key = t;  // rotated, not reflected: opposite sides are different triangles
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    if (!seen.insert(key).second) continue;
    for (int& index : t) {
      if (renumbered[index] < 0) {
        renumbered[index] = static_cast<int>(result.vertices.size());
        result.vertices.push_back(pool.vertices()[index]);
      }
      index = renumbered[index];
    }
    result.triangles.push_back(t);
  }
  return result;
}

Topology TopologyOf(const TriMesh& mesh) {
  Topology topology;
  ForEachEdge(SortedHalfEdges(mesh), [&](const HalfEdge* first, const HalfEdge* last) {
    const auto count = last - first;
    topology.open_edges += count == 1;
    topology.crowded_edges += count > 2;
    topology.flipped_edges += count == 2 && first[0].forward == first[1].forward;
  });
  const std::vector<int> shells = ShellOfTriangles(mesh);
  if (!shells.empty()) topology.shells = *std::max_element(shells.begin(), shells.end()) + 1;
  topology.pinched_vertices = CountPinched(mesh);
  return topology;
}

std::vector<int> ShellOfTriangles(const TriMesh& mesh) {
  std::vector<int> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  ForEachEdge(SortedHalfEdges(mesh), [&](const HalfEdge* first, const HalfEdge* last) {
    for (const HalfEdge* e = first + 1; e < last; ++e)
      parent[Root(parent, e->triangle)] = Root(parent, first->triangle);
  });
  std::vector<int> number(parent.size(), -1), shell(parent.size());
  int count = 0;
  for (std::size_t t = 0; t < parent.size(); ++t) {
    int& n = number[Root(parent, static_cast<int>(t))];
    if (n < 0) n = count++;
    shell[t] = n;
  }
  return shell;
}

TriMesh Submesh(const TriMesh& mesh, const std::vector<int>& triangles) {
  TriMesh result;
  std::unordered_map<int, int> renumbered;
  for (const int t : triangles) {
    std::array<int, 3> triangle = mesh.triangles[t];
    for (int& index : triangle) {
      const auto [at, fresh] = renumbered.emplace(index, static_cast<int>(result.vertices.size()));
      if (fresh) result.vertices.push_back(mesh.vertices[index]);
      index = at->second;
    }
    result.triangles.push_back(triangle);
  }
  return result;
}

TriMesh WithConsistentWinding(const TriMesh& mesh) {
  // Neighbours through ordinary edges, with whether they run the same way (one must be turned).
  std::vector<std::vector<std::pair<int, bool>>> neighbours(mesh.triangles.size());
  ForEachEdge(SortedHalfEdges(mesh), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2) return;
    const bool differ = first[0].forward == first[1].forward;
    neighbours[first[0].triangle].emplace_back(first[1].triangle, differ);
    neighbours[first[1].triangle].emplace_back(first[0].triangle, differ);
  });
  TriMesh result = mesh;
  std::vector<int> state(mesh.triangles.size(), -1);  // 1 turned, 0 as it was, -1 not reached
  for (std::size_t seed = 0; seed < state.size(); ++seed) {
    if (state[seed] >= 0) continue;
    std::vector<int> patch = {static_cast<int>(seed)};
    state[seed] = 0;
    for (std::size_t i = 0; i < patch.size(); ++i)
      for (const auto& [next, differ] : neighbours[patch[i]]) {
        if (state[next] >= 0) continue;
        state[next] = differ ? 1 - state[patch[i]] : state[patch[i]];
        patch.push_back(next);
      }
    for (const int t : patch)
      if (state[t] == 1) std::swap(result.triangles[t][1], result.triangles[t][2]);
    if (MassPropertiesOf(Submesh(result, patch)).volume >= 0) continue;
    for (const int t : patch) std::swap(result.triangles[t][1], result.triangles[t][2]);
  }
  return result;
}

}  // namespace dexremoe
