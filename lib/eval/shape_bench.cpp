#include "eval/shape_bench.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "base/error.h"
#include "base/log.h"
#include "geometry/object_files.h"
#include "shape/grouping.h"

namespace dexremoe {
namespace {

using Feature = Eigen::VectorXd;

Feature FeatureOf(const ShapeDescriptor& descriptor) {
  return Eigen::Map<const Eigen::VectorXf>(descriptor.feature.data(),
                                           std::ssize(descriptor.feature))
      .cast<double>();
}

double CosineDistance(const Feature& a, const Feature& b) {
  return 1 - a.dot(b) / std::max(a.norm() * b.norm(), 1e-30);
}

double Median(std::vector<double> values) {
  if (values.empty()) return NAN;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Descriptors of a set: features [object][orientation], of the other sample in the first
// orientation, and whether the category was told right.
struct Described {
  std::vector<std::vector<Feature>> feature;
  std::vector<Feature> other_sample;
  std::vector<std::vector<bool>> right;
};

std::vector<Eigen::Quaternionf> Orientations(std::size_t object, int count, std::uint64_t seed) {
  std::vector<Eigen::Quaternionf> orientations;
  for (int r = 0; r < count; ++r) {
    Rng rng(seed, Stream::kTest, {object, static_cast<std::uint64_t>(r)});
    const auto [w, x, y, z] = rng.UnitQuaternion();
    orientations.push_back(Eigen::Quaterniond(w, x, y, z).cast<float>());
  }
  return orientations;
}

template <typename T>
Described DescribeSet(const ShapeNet& net, const ShapeSet& set, int rotations, std::uint64_t seed,
                      ThreadPool& pool) {
  Described described;
  for (std::size_t i = 0; i < set.clouds.size(); ++i) {
    const LabelledCloud& cloud = set.clouds[i];
    const auto orientations = Orientations(i, rotations, seed);
    auto& features = described.feature.emplace_back();
    auto& right = described.right.emplace_back();
    for (const auto& d : DescribeRotated<T>(net, cloud.points, orientations, pool)) {
      features.push_back(FeatureOf(d));
      const auto best = std::max_element(d.logits.begin(), d.logits.end()) - d.logits.begin();
      right.push_back(best == cloud.category);
    }
    described.other_sample.push_back(FeatureOf(
        DescribeRotated<T>(net, set.resampled[i].points, {orientations.data(), 1}, pool)[0]));
  }
  return described;
}

// Subtracts the mean of all: what every shape has in common would make all of them look alike.
void Center(Described& described) {
  Feature mean = Feature::Zero(described.feature[0][0].size());
  for (const auto& features : described.feature)
    for (const Feature& f : features)
      mean += f / static_cast<double>(features.size() * described.feature.size());
  for (auto& features : described.feature)
    for (Feature& f : features) f -= mean;
  for (Feature& f : described.other_sample) f -= mean;
}

void MeasureAccuracy(const ShapeSet& set, const Described& described, int categories,
                     ShapeStudy& study) {
  const auto objects = static_cast<double>(set.clouds.size());
  std::vector<double> of_category(categories, 0), count(categories, 0);
  double square = 0;
  for (std::size_t i = 0; i < set.clouds.size(); ++i) {
    const auto& right = described.right[i];
    const auto hits = static_cast<double>(std::count(right.begin(), right.end(), true));
    const double accuracy = hits / static_cast<double>(right.size());
    study.accuracy += accuracy / objects;
    square += accuracy * accuracy / objects;
    study.always += (accuracy == 1) / objects;
    of_category[set.clouds[i].category] += accuracy;
    ++count[set.clouds[i].category];
  }
  study.error = 1.96 * std::sqrt(std::max(square - study.accuracy * study.accuracy, 0.0) / objects);
  for (int c = 0; c < categories; ++c)
    study.by_category.push_back(count[c] > 0 ? of_category[c] / count[c] : NAN);
}

void MeasureDistances(const ShapeSet& set, const Described& described, ShapeStudy& study) {
  std::vector<double> resampled, rotated, same, other;
  for (std::size_t i = 0; i < set.clouds.size(); ++i) {
    const auto& features = described.feature[i];
    resampled.push_back(CosineDistance(features[0], described.other_sample[i]));
    for (std::size_t r = 0; r < features.size(); ++r)
      for (std::size_t s = 0; s < r; ++s)
        rotated.push_back(CosineDistance(features[r], features[s]));
    for (std::size_t j = 0; j < i; ++j)
      (set.clouds[i].category == set.clouds[j].category ? same : other)
          .push_back(CosineDistance(features[0], described.feature[j][0]));
  }
  study.resampled = Median(resampled);
  study.rotated = Median(rotated);
  study.same_category = Median(same);
  study.other_category = Median(other);
}

void Record(const std::string& row, const ShapeStudy& study, ShapeBenchResult& result) {
  const auto add = [&](const char* table, const std::string& column, double value, int decimals,
                       const std::string& spread = "") {
    result.measurements.push_back({table, row, column, value, decimals, spread});
  };
  add("accuracy", "all", 100 * study.accuracy, 1, fmt::format("+- {:.1f}", 100 * study.error));
  add("accuracy", "every orientation", 100 * study.always, 1);
  for (std::size_t c = 0; c < study.by_category.size(); ++c)
    add("accuracy", kShapeCategories[c], 100 * study.by_category[c], 0);
  add("distance", "other points", study.resampled, 3);
  add("distance", "other pose", study.rotated, 3);
  add("distance", "object of the category", study.same_category, 3);
  add("distance", "object of another", study.other_category, 3);
}

}  // namespace

ShapeSet MakeShapeSet(const std::string& name, std::vector<LabelledCloud> clouds,
                      const CloudOptions& options, std::uint64_t seed) {
  ShapeSet set{name, std::move(clouds), {}};
  for (const LabelledCloud& cloud : set.clouds) {
    const ObjectMesh object = ReadObjectMesh(cloud.folder + "/mesh.h5");
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& p : SampleCloud(object.mesh, options, seed).points)
      points.push_back(p.cast<float>());
    set.resampled.push_back({cloud.name, cloud.category, ToUnitSphere(points), cloud.folder});
  }
  return set;
}

template <typename T>
ShapeStudy StudyShapes(const ShapeNet& net, const ShapeSet& set, int rotations, std::uint64_t seed,
                       ThreadPool& pool) {
  if (set.clouds.empty()) Fail("{}: expected objects, found none", set.name);
  Described described = DescribeSet<T>(net, set, rotations, seed, pool);
  Center(described);
  ShapeStudy study;
  MeasureAccuracy(set, described, net.net.sizes().categories, study);
  MeasureDistances(set, described, study);
  return study;
}
template ShapeStudy StudyShapes<float>(const ShapeNet&, const ShapeSet&, int, std::uint64_t,
                                       ThreadPool&);
template ShapeStudy StudyShapes<BFloat16>(const ShapeNet&, const ShapeSet&, int, std::uint64_t,
                                          ThreadPool&);

void ShapeBenchOptions::Register(Options& options) {
  sizes.Register(options);
  train.Register(options);
  options.Add("rotations", &rotations, "orientations that an object is tried in").Range(1, 10000);
  options.Add("seed", &seed, "of the training and of the orientations");
}

void RunShapeBench(const ShapeBenchOptions& options, const LabelledClouds& clouds,
                   const std::vector<ShapeSet>& sets, const std::vector<std::string>& precisions,
                   ThreadPool& pool, const std::function<void(const ShapeBenchResult&)>& report) {
  ShapeBenchResult result;
  result.rotations = options.rotations;
  for (const std::string& precision : precisions) {
    ShapeNet net(options.sizes);
    ShapeTrainOptions train = options.train;
    train.precision = precision;
    const std::clock_t start = std::clock();
    const ShapeTraining training = TrainShape(clouds, train, options.seed, pool, net);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    result.measurements.push_back({"training", precision, "processor s", seconds, 0, ""});
    result.measurements.push_back({"training", precision, "right in the last epoch, %",
                                   100 * training.curve.train_accuracy.back(), 1, ""});
    for (const ShapeSet& set : sets) {
      const std::string row = fmt::format("{} ({}), {}", set.name, set.clouds.size(), precision);
      LogInfo("{}", row);
      Record(row,
             precision == "bf16"
                 ? StudyShapes<BFloat16>(net, set, options.rotations, options.seed, pool)
                 : StudyShapes<float>(net, set, options.rotations, options.seed, pool),
             result);
    }
    report(result);
  }
}

std::string ShapeBenchResult::Markdown() const {
  return fmt::format(
      "# Telling shapes apart\n\n{}.\n\nPointNet++ trained on the training objects in float32 "
      "(f32) "
      "and in bfloat16 (bf16), and tried in the same precision on objects it never saw.\n\n"
      "## Training\n\nProcessor time of all threads together, trials on held-out objects "
      "included.\n\n{}\n## Accuracy\n\n% of {} orientations of each object (Haar) in which its "
      "category is told right, with a 95 % interval over objects; % of the objects that are told "
      "right in every one of them; and by category.\n\n{}\n## Feature\n\nCosine distance "
      "(1 - cos) between descriptors p, less the mean of the set; medians: to other points of the "
      "same surface in the same pose, to another pose, to another object of the same category and "
      "of another one.\n\n{}",
      MachineText(), MarkdownOf(measurements, "training", "precision"), rotations,
      MarkdownOf(measurements, "accuracy", "objects"),
      MarkdownOf(measurements, "distance", "objects"));
}

}  // namespace dexremoe
