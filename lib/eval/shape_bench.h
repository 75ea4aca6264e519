// How well PointNet++ tells the categories of objects it never saw, and how little its feature
// depends on which points were sampled and on the pose.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "eval/sim_table.h"
#include "shape/cloud.h"
#include "shape/training.h"

namespace dexremoe {

// Objects to try a network on, each sampled twice.
struct ShapeSet {
  std::string name;  // "built-in, out of distribution"
  std::vector<LabelledCloud> clouds;
  std::vector<LabelledCloud> resampled;  // other points of the same surfaces
};

// The clouds and, sampled anew from each object's mesh.h5 with `seed`, their other points. Throws
// Error naming the mesh that is missing or wrong.
ShapeSet MakeShapeSet(const std::string& name, std::vector<LabelledCloud> clouds,
                      const CloudOptions& options, std::uint64_t seed);

struct ShapeStudy {
  double accuracy = 0;  // part of the orientations in which an object's category is told right
  double error = 0;     // half of a 95 % interval of it, over objects
  double always = 0;    // part of the objects that are told right in every orientation
  std::vector<double> by_category;  // accuracy [categories]; NaN without objects
  // Medians of the cosine distance 1 - cos of two descriptors, less the mean of all: of two samples
  // of an object in one pose; of two poses; of two objects of one category and of two. NaN where
  // there is no pair.
  double resampled = 0, rotated = 0, same_category = 0, other_category = 0;
};

// Describes every object in `rotations` orientations (Haar, by seed) with weights and activations
// stored as T: float or BFloat16. Throws Error for a set without objects.
template <typename T>
ShapeStudy StudyShapes(const ShapeNet& net, const ShapeSet& set, int rotations, std::uint64_t seed,
                       ThreadPool& pool);

struct ShapeBenchOptions {
  PointNetSizes sizes;
  ShapeTrainOptions train;
  int rotations = 3;  // that an object of a set is tried in
  std::uint64_t seed = 1;
  void Register(Options& options);  // section "shape"; "rotations" and "seed" without one
};

struct ShapeBenchResult {
  std::vector<Measurement> measurements;
  int rotations = 0;
  std::string Markdown() const;
};

// Trains a network in each of `precisions`, tries it on each set and then shows `report` what has
// been measured so far.
void RunShapeBench(const ShapeBenchOptions& options, const LabelledClouds& clouds,
                   const std::vector<ShapeSet>& sets, const std::vector<std::string>& precisions,
                   ThreadPool& pool, const std::function<void(const ShapeBenchResult&)>& report);

}  // namespace dexremoe
