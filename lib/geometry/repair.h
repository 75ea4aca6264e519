// From whatever a file holds to one closed, outward-oriented shell.
#pragma once

#include <string>

#include "geometry/mesh.h"

namespace dexremoe {

// Merges vertices closer than about `tolerance` (m; 0 merges exactly equal ones), then drops
// triangles with a repeated corner, duplicated triangles and vertices that no triangle uses.
// The order of first appearance is kept.
TriMesh Weld(const TriMesh& mesh, double tolerance);

// What is wrong with a welded mesh. Edges are counted once.
struct Topology {
  int shells = 0;            // groups of triangles connected through edges
  int open_edges = 0;        // one triangle
  int crowded_edges = 0;     // more than two triangles
  int flipped_edges = 0;     // two triangles that run the same way
  int pinched_vertices = 0;  // the triangles around it form more than one fan
  bool ClosedManifold() const {
    return open_edges == 0 && crowded_edges == 0 && flipped_edges == 0 && pinched_vertices == 0;
  }
};
Topology TopologyOf(const TriMesh& mesh);

// Index of the shell of every triangle, numbered in order of first appearance.
std::vector<int> ShellOfTriangles(const TriMesh& mesh);

// The mesh of some of the triangles, with only the vertices that they use.
TriMesh Submesh(const TriMesh& mesh, const std::vector<int>& triangles);

// Turns triangles so that neighbours agree across every edge of two triangles, and every connected
// patch so that its volume is positive: each shell counts as solid, cavities included.
TriMesh WithConsistentWinding(const TriMesh& mesh);

struct RepairOptions {
  int resolution = 80;        // voxels along the longest side of the distance field
  int max_triangles = 30000;  // a finer shell is made again with fewer voxels
  int max_closed = 200000;    // a closed mesh with more triangles is remeshed all the same
  // Largest fraction of the source surface that may lie farther than one voxel outside the new
  // shell before the shell is thickened by an offset (thin sheets would vanish).
  double lost_surface = 0.005;
};

struct RepairResult {
  TriMesh mesh;      // one closed manifold shell, positive volume
  std::string text;  // "closed as it was" or "remeshed: 31 shells, 324 open edges ..."
  // Symmetric Hausdorff distance between the source's surface and the mesh, in the source's units;
  // sampled, so a slight underestimate. What the source holds inside the solid does not count: a
  // solid has no inner surfaces.
  double source_distance = 0;
};

// Welds, and remeshes through a distance field signed by winding number where welding is not
// enough: for open, crowded, several or crossing shells. Sheets that a solid cannot have become
// plates of 1.75 voxels at most, as the text says. Throws Error (naming `label`) when nothing with a
// volume is left.
RepairResult MakeClosedShell(const TriMesh& mesh, const RepairOptions& options,
                             const std::string& label);

}  // namespace dexremoe
