// Clusters of voxels and their hulls: the pieces that convex decomposition cuts and joins.
#pragma once

#include <vector>

#include "geometry/concavity.h"
#include "geometry/mesh.h"
#include "geometry/voxel_solid.h"

namespace dexremoe {

struct Cluster {
  std::vector<int> voxels;  // indices into VoxelSolid::voxels, rising
  double solid = 0;         // volume of the solid within, m^3
  TriMesh hull;             // of the solid within
  double hull_volume = 0;   // m^3
  double concavity = 0;     // what it costs, m^3 (Concavity::CostOf)
  int deepest = -1;         // the voxel deepest below the hull's surface (Concavity::Fit)
  // What is wrong with a single convex part in its place.
  double Cost() const { return hull_volume - solid + concavity; }
};

// Hull that always exists: points in a plane, on a line or at one place are given a thickness.
TriMesh SolidHull(const std::vector<Eigen::Vector3d>& points, double thickness);

Cluster MakeCluster(const VoxelSolid& solid, const Concavity& concavity, std::vector<int> voxels);

// Hull of all points of the cluster's solid; Cluster::hull is that of the extreme ones.
TriMesh ExactHull(const VoxelSolid& solid, const Cluster& cluster);

// Cuts at the best plane between voxel layers along x, y or z, then separates what is no longer
// connected. One cluster comes back when there is nothing to cut.
// Score of a plane (V-HACD): summed excess of both hulls + balance * |difference of volumes|. The
// plane of the best score competes, by the summed costs of the pieces, with those that lay the
// deepest voxel open: a narrow groove holds too little volume to draw a plane.
// NOTE(paper): V-HACD's third term, which favours cuts across an axis of revolution, is left out.
std::vector<Cluster> CutBest(const VoxelSolid& solid, const Concavity& concavity,
                             const Cluster& cluster, double balance);

// Joins the pair whose common hull costs least, by what it adds to the union of the two hulls and
// to the greater of their concavities, until at most `most` are left and no joint is nearly free
// (costs less than `free_cost`, m^3). Pairs are tried when their bounding boxes are within `reach`
// of each other.
void MergeClusters(std::size_t most, double free_cost, double reach, const Concavity& concavity,
                   std::vector<Cluster>& clusters);

}  // namespace dexremoe
