// Training PointNet++ to tell the categories from clouds in any orientation.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/options.h"
#include "base/thread_pool.h"
#include "shape/augment.h"
#include "shape/shape_net.h"

namespace dexremoe {

struct LabelledCloud {
  std::string name;
  int category = 0;
  std::vector<Eigen::Vector3f> points;  // unit sphere
  std::string folder;                   // of mesh.h5 and cloud.h5; empty for one made in memory
};

// What objects.csv says, with every object's FOLDER/cloud.h5.
struct LabelledClouds {
  std::vector<LabelledCloud> train, held_out;  // splits "train" and "ood"
  std::vector<std::string> files;              // the clouds read, in order
};
// Throws Error naming file, line and field, also when no object is for training.
LabelledClouds ReadLabelledClouds(const std::string& objects_csv);

struct ShapeTrainOptions {
  int epochs = 40;
  int epoch_clouds = 240;   // clouds in an epoch: variants of the objects in turn
  int batch = 16;           // clouds per step
  double rate = 1e-3;       // Adam's, at the start (the original's)
  double decay = 0.7;       // the rate is multiplied by it (the original's) ...
  int decays = 6;           // ... so many times, evenly spread over the training
  double max_norm = 1;      // bound on the gradient's norm
  int rotations = 8;        // orientations in which a held-out object is tried
  int evaluate_every = 10;  // epochs between trials
  // "f32", "bf16" or "auto": what weights and activations are stored in while they train; the
  // trained weights are float32 always.
  std::string precision = "auto";
  AugmentOptions augment;
  void Register(Options& options);
};

// One row per epoch. Accuracies are parts of clouds; held-out ones are NaN where none was tried.
struct ShapeCurve {
  std::vector<double> epoch, rate, loss, train_accuracy, held_out_accuracy;
};

// Every object in random orientations, not otherwise altered.
struct ShapeTrial {
  std::vector<std::string> names;
  std::vector<double> accuracy;         // per object
  std::vector<std::int32_t> confusion;  // [6 true, 6 predicted] counts
  double Accuracy() const;              // over all trials; NaN without objects
};
ShapeTrial TryShapes(const ShapeNet& net, const std::vector<LabelledCloud>& clouds, int rotations,
                     std::uint64_t seed, ThreadPool& pool);

struct ShapeTraining {
  ShapeCurve curve;
  ShapeTrial held_out;            // of the trained network
  std::string precision = "f32";  // that it was trained in: "f32" or "bf16"
};

// Initialises net.params and trains them with Adam on the cross-entropy of the category. The result
// depends on the seed and the precision, not on the number of workers. Throws Error for a precision
// that is not to be had on this processor.
ShapeTraining TrainShape(const LabelledClouds& clouds, const ShapeTrainOptions& options,
                         std::uint64_t seed, ThreadPool& pool, ShapeNet& net);

}  // namespace dexremoe
