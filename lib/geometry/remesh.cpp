#include "geometry/remesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

#include "base/check.h"

namespace dexremoe {
namespace {

// Cube corners are numbered by bits x, y, z. Edge e = 4 * axis + the other two bits in axis order.
struct CubeEdge {
  int from, to;  // corners, `to` one step along the axis
};
constexpr std::array<CubeEdge, 12> kEdges = {{{0, 1},
                                              {2, 3},
                                              {4, 5},
                                              {6, 7},
                                              {0, 2},
                                              {1, 3},
                                              {4, 6},
                                              {5, 7},
                                              {0, 4},
                                              {1, 5},
                                              {2, 6},
                                              {3, 7}}};
// Faces -x, +x, -y, +y, -z, +z: corners counter-clockwise seen from outside the cube.
constexpr std::array<std::array<int, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

int EdgeBetween(int a, int b) {
  for (int e = 0; e < 12; ++e)
    if ((kEdges[e].from == a && kEdges[e].to == b) || (kEdges[e].from == b && kEdges[e].to == a))
      return e;
  return -1;
}

// Surface patches of one cube: loops of crossed edges.
struct Loops {
  std::array<int, 12> loop_of_edge;  // -1: not crossed
  int count = 0;
};

// The two edges that follow each crossed edge on the surface, one per face that it borders.
struct Pairing {
  std::array<std::array<int, 2>, 12> next;
  std::array<int, 12> degree{};
  void Join(int a, int b) {
    next[a][degree[a]++] = b;
    next[b][degree[b]++] = a;
  }
};

// Joins the crossed edges of each face in pairs. On an ambiguous face the inside corners are kept
// apart, or joined where `joined` (bit per face) says so.
Pairing PairCrossedEdges(unsigned inside, unsigned joined) {
  Pairing pairing;
  for (int f = 0; f < 6; ++f) {
    std::array<int, 4> crossed;  // edges around the face that are crossed
    int count = 0, first_corner = 0;
    for (int k = 0; k < 4; ++k) {
      const int a = kFaces[f][k], b = kFaces[f][(k + 1) % 4];
      if ((inside >> a & 1) == (inside >> b & 1)) continue;
      if (count == 0) first_corner = b;
      crossed[count++] = EdgeBetween(a, b);
    }
    if (count == 0) continue;
    // On an ambiguous face, crossed edges 0 and 1 enclose first_corner.
    const bool first_inside = inside >> first_corner & 1;
    const bool around_first = count == 2 || first_inside != static_cast<bool>(joined >> f & 1);
    if (around_first) pairing.Join(crossed[0], crossed[1]);
    if (count == 4 && around_first) pairing.Join(crossed[2], crossed[3]);
    if (count == 4 && !around_first) {
      pairing.Join(crossed[1], crossed[2]);
      pairing.Join(crossed[3], crossed[0]);
    }
  }
  return pairing;
}

Loops FindLoops(unsigned inside, unsigned joined) {
  const Pairing pairing = PairCrossedEdges(inside, joined);
  Loops loops;
  loops.loop_of_edge.fill(-1);
  for (int start = 0; start < 12; ++start) {
    if (pairing.degree[start] == 0 || loops.loop_of_edge[start] >= 0) continue;
    int edge = start;
    while (edge >= 0) {
      loops.loop_of_edge[edge] = loops.count;
      int onward = -1;
      for (const int other : pairing.next[edge])
        if (loops.loop_of_edge[other] < 0) onward = other;
      edge = onward;
    }
    ++loops.count;
  }
  return loops;
}

class Extractor {
 public:
  Extractor(const DistanceGrid& grid, double level) : grid_(grid), level_(level) {}

  TriMesh Run() {
    FindActiveCubes();
    for (const std::size_t cube : cubes_) SplitAmbiguousFaces(cube);
    for (const std::size_t cube : cubes_) PlaceVertices(cube);
    for (const std::size_t cube : cubes_) EmitQuads(cube);
    return std::move(mesh_);
  }

 private:
  // A cube is named by the index of its lowest node.
  std::array<int, 3> Node(std::size_t index) const {
    const auto nx = static_cast<std::size_t>(grid_.dims[0]),
               ny = static_cast<std::size_t>(grid_.dims[1]);
    return {static_cast<int>(index % nx), static_cast<int>(index / nx % ny),
            static_cast<int>(index / (nx * ny))};
  }
  std::size_t Corner(std::size_t cube, int corner) const {
    const auto [x, y, z] = Node(cube);
    return grid_.Index(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
  }
  bool Inside(std::size_t node) const {
    if (!(grid_.values[node] < level_)) return false;
    const auto at = Node(node);
    for (int k = 0; k < 3; ++k)
      if (at[k] == 0 || at[k] == grid_.dims[k] - 1) return false;
    return true;
  }

  void FindActiveCubes() {
    std::vector<std::uint8_t> inside(grid_.values.size());
    for (std::size_t i = 0; i < inside.size(); ++i) inside[i] = Inside(i);
    for (int z = 0; z + 1 < grid_.dims[2]; ++z)
      for (int y = 0; y + 1 < grid_.dims[1]; ++y)
        for (int x = 0; x + 1 < grid_.dims[0]; ++x) {
          unsigned signs = 0;
          for (int c = 0; c < 8; ++c)
            signs |= static_cast<unsigned>(
                         inside[grid_.Index(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))])
                     << c;
          if (signs == 0 || signs == 255) continue;
          cubes_.push_back(grid_.Index(x, y, z));
          cells_[cubes_.back()] = {signs, 0, {}};
        }
  }

  // When both cubes at an ambiguous face would run one loop through it twice, an edge of the result
  // would have four triangles. Joining the inside corners there splits both loops. Splitting never
  // brings back such a case elsewhere, so one pass is enough.
  void SplitAmbiguousFaces(std::size_t cube) {
    const auto [x, y, z] = Node(cube);
    const std::array<std::size_t, 3> beyond = {grid_.Index(x + 1, y, z), grid_.Index(x, y + 1, z),
                                               grid_.Index(x, y, z + 1)};
    for (int axis = 0; axis < 3; ++axis) {
      const auto neighbour = cells_.find(beyond[axis]);
      if (neighbour == cells_.end()) continue;
      if (!OneLoopTwice(cells_.at(cube), 2 * axis + 1) ||
          !OneLoopTwice(neighbour->second, 2 * axis))
        continue;
      cells_.at(cube).joined |= 1u << (2 * axis + 1);
      neighbour->second.joined |= 1u << (2 * axis);
    }
  }

  struct Cell {
    unsigned inside = 0;
    unsigned joined = 0;
    std::array<int, 12> vertex_of_edge{};
  };

  static bool OneLoopTwice(const Cell& cell, int face) {
    const Loops loops = FindLoops(cell.inside, cell.joined);
    int loop = -1;
    for (int k = 0; k < 4; ++k) {
      const int own = loops.loop_of_edge[EdgeBetween(kFaces[face][k], kFaces[face][(k + 1) % 4])];
      if (own < 0 || (loop >= 0 && own != loop)) return false;
      loop = own;
    }
    return true;
  }

  Eigen::Vector3d Crossing(std::size_t from, std::size_t to) const {
    const double a = grid_.values[from] - level_, b = grid_.values[to] - level_;
    // Kept off the nodes, where patches of neighbouring cells would meet in a point; border nodes
    // count as outside whatever their value.
    const double t = a != b ? std::clamp(a / (a - b), 0.02, 0.98) : 0.5;
    const auto u = Node(from), v = Node(to);
    const Eigen::Vector3d p = grid_.Position(u[0], u[1], u[2]),
                          q = grid_.Position(v[0], v[1], v[2]);
    return p + t * (q - p);
  }

  void PlaceVertices(std::size_t cube) {
    Cell& cell = cells_.at(cube);
    const Loops loops = FindLoops(cell.inside, cell.joined);
    std::array<Eigen::Vector3d, 4> sum;
    std::array<int, 4> count{};
    sum.fill(Eigen::Vector3d::Zero());
    const int first = static_cast<int>(mesh_.vertices.size());
    for (int e = 0; e < 12; ++e) {
      const int loop = loops.loop_of_edge[e];
      cell.vertex_of_edge[e] = loop < 0 ? -1 : first + loop;
      if (loop < 0) continue;
      sum[loop] += Crossing(Corner(cube, kEdges[e].from), Corner(cube, kEdges[e].to));
      ++count[loop];
    }
    for (int i = 0; i < loops.count; ++i) mesh_.vertices.push_back(sum[i] / count[i]);
  }

  // One quad for each crossed edge at the cube's highest corner: its four cubes all exist there.
  void EmitQuads(std::size_t cube) {
    const Cell& cell = cells_.at(cube);
    const auto at = Node(cube);
    for (int axis = 0; axis < 3; ++axis) {
      const int top = 4 * axis + 3;
      if (cell.vertex_of_edge[top] < 0) continue;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      // The four cubes around the edge, counter-clockwise seen from the positive axis.
      std::array<int, 4> quad;
      constexpr std::array<std::array<int, 2>, 4> kAround = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
      for (int k = 0; k < 4; ++k) {
        std::array<int, 3> other = at;
        other[u] += kAround[k][0];
        other[v] += kAround[k][1];
        std::array<int, 3> corner = {1, 1, 1};
        corner[u] -= kAround[k][0];
        corner[v] -= kAround[k][1];
        corner[axis] = 0;
        const int from = corner[0] | corner[1] << 1 | corner[2] << 2;
        const int edge = EdgeBetween(from, from | 1 << axis);
        quad[k] = cells_.at(grid_.Index(other[0], other[1], other[2])).vertex_of_edge[edge];
        DEX_CHECK_GE(quad[k], 0);
      }
      const bool upward = cell.inside >> kEdges[top].from & 1;  // inside below: normal along +axis
      if (!upward) std::swap(quad[1], quad[3]);
      EmitTwoTriangles(quad);
    }
  }

  void EmitTwoTriangles(const std::array<int, 4>& q) {
    const auto& p = mesh_.vertices;
    const bool first_diagonal = (p[q[0]] - p[q[2]]).norm() <= (p[q[1]] - p[q[3]]).norm();
    if (first_diagonal) {
      mesh_.triangles.push_back({q[0], q[1], q[2]});
      mesh_.triangles.push_back({q[0], q[2], q[3]});
    } else {
      mesh_.triangles.push_back({q[0], q[1], q[3]});
      mesh_.triangles.push_back({q[1], q[2], q[3]});
    }
  }

  const DistanceGrid& grid_;
  double level_;
  std::vector<std::size_t> cubes_;
  std::unordered_map<std::size_t, Cell> cells_;
  TriMesh mesh_;
};

}  // namespace

TriMesh ExtractLevelSet(const DistanceGrid& grid, double level) {
  return Extractor(grid, level).Run();
}

}  // namespace dexremoe
