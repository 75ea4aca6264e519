// How well and how fast meshes become closed shells and convex parts: `bench_decompose`.
#pragma once

#include <string>
#include <vector>

#include "base/options.h"
#include "base/thread_pool.h"
#include "geometry/decompose.h"
#include "geometry/scale.h"

namespace dexremoe {

struct DecomposeBenchOptions {
  int every = 1;        // takes every n-th mesh of a folder
  std::string peer;     // program of tests/bench/hacd; empty: none
  int peer_every = 30;  // it takes every n-th mesh
  ScaleOptions scale;
  DecomposeOptions decompose;
  void Register(Options& options);
};

// What one mesh gave. Seconds are processor time of the one thread that does the work.
struct DecomposedMesh {
  std::string set, name;
  int source_triangles = 0, triangles = 0, parts = 0;
  double repair_seconds = 0;
  double source_ratio = 0;  // distance of the closed mesh to its source (symmetric Hausdorff) /
                            // diagonal
  double seconds = 0;       // from the closed mesh to the parts
  double diagonal = 0;      // of the closed mesh, m
  double voxel = 0;         // m
  DecompositionQuality quality;
  // The part that sticks out farthest, in voxels.
  double StickOut() const;
};

// Repairs, scales and decomposes the mesh files of `folder` (see ListMeshes), one file per thread
// at a time. The set is named after the folder.
std::vector<DecomposedMesh> BenchFolder(const std::string& folder,
                                        const DecomposeBenchOptions& options, ThreadPool& pool);

// The same meshes by options.peer, in a set of its own that is named after it: `SET, libHACD`.
// Throws Error naming the program when it fails.
std::vector<DecomposedMesh> BenchPeerFolder(const std::string& folder,
                                            const DecomposeBenchOptions& options, ThreadPool& pool);

// Medians and spreads of every set beside V-HACD's figures, with how to read them.
std::string DecomposeMarkdown(const std::vector<DecomposedMesh>& meshes,
                              const DecomposeBenchOptions& options);
// One line per mesh.
std::string DecomposeCsv(const std::vector<DecomposedMesh>& meshes);

}  // namespace dexremoe
