#include "shape/shape_files.h"

#include <cmath>

#include "base/error.h"
#include "io/csv.h"

namespace dexremoe {
namespace {

using Ints = std::vector<std::int32_t>;

void WriteSizes(H5Writer& file, const PointNetSizes& sizes) {
  const auto widths = [&](const char* name, const std::vector<int>& values, const char* doc) {
    file.Write(name, Ints(values.begin(), values.end()), {static_cast<std::int64_t>(values.size())},
               {"1", "layer", doc});
  };
  file.WriteScalar<std::int32_t>("sizes/points", sizes.points,
                                 {"1", "", "points of a cloud that enter at most"});
  file.Write("sizes/levels",
             Ints{sizes.level1.centroids, sizes.level1.neighbors, sizes.level2.centroids,
                  sizes.level2.neighbors},
             {2, 2}, {"1", "level, (centroids, neighbors)", "set-abstraction levels 1 and 2"});
  file.Write("sizes/radii", std::vector<double>{sizes.level1.radius, sizes.level2.radius}, {2},
             {"1", "level", "radius of the balls, cloud in the unit sphere"});
  widths("sizes/sa1_widths", sizes.widths1, "network of level 1");
  widths("sizes/sa2_widths", sizes.widths2, "network of level 2");
  widths("sizes/sa3_widths", sizes.widths3, "network over all centroids");
  widths("sizes/head_widths", sizes.head, "layers before the descriptor");
}

PointNetSizes ReadSizes(const H5Reader& file) {
  const auto widths = [&](const char* name) {
    const Ints values = file.ReadValues<std::int32_t>(name, {-1});
    return std::vector<int>(values.begin(), values.end());
  };
  PointNetSizes sizes;
  sizes.points = file.ReadScalar<std::int32_t>("sizes/points");
  const Ints levels = file.ReadValues<std::int32_t>("sizes/levels", {2, 2});
  const auto radii = file.ReadValues<double>("sizes/radii", {2});
  sizes.level1 = {levels[0], radii[0], levels[1]};
  sizes.level2 = {levels[2], radii[1], levels[3]};
  sizes.widths1 = widths("sizes/sa1_widths");
  sizes.widths2 = widths("sizes/sa2_widths");
  sizes.widths3 = widths("sizes/sa3_widths");
  sizes.head = widths("sizes/head_widths");
  return sizes;
}

void WriteCurve(H5Writer& file, const ShapeCurve& curve) {
  const auto column = [&](const char* name, const std::vector<double>& values, const char* doc) {
    file.Write(name, values, {static_cast<std::int64_t>(values.size())}, {"1", "epoch", doc});
  };
  column("curve/epoch", curve.epoch, "number of the epoch, from 1");
  column("curve/rate", curve.rate, "learning rate");
  column("curve/loss", curve.loss, "mean cross-entropy of the training clouds, nats");
  column("curve/train_accuracy", curve.train_accuracy, "part of the training clouds told right");
  column("curve/held_out_accuracy", curve.held_out_accuracy,
         "part of the held-out clouds told right; nan where not tried");
}

void WriteTrial(H5Writer& file, const ShapeTrial& trial) {
  const auto objects = static_cast<std::int64_t>(trial.names.size());
  const auto categories = static_cast<std::int64_t>(kShapeCategories.size());
  file.WriteScalar<double>("held_out/accuracy", trial.Accuracy(),
                           {"1", "",
                            "part of the clouds of held-out objects told right; nan "
                            "without held-out objects"});
  file.Write("held_out/confusion", trial.confusion, {categories, categories},
             {"1", "true category, predicted category", "numbers of clouds"});
  if (objects == 0) return;
  file.WriteStrings("held_out/objects", trial.names, {"1", "object", "names"});
  file.Write("held_out/object_accuracy", trial.accuracy, {objects},
             {"1", "object", "part of its orientations told right"});
}

}  // namespace

void WriteShapeNet(const std::string& path, const ShapeNet& net, const ShapeTraining& training,
                   const Provenance& provenance) {
  H5Writer file(path, kShapeNetFormat, provenance);
  file.WriteStrings("categories", {kShapeCategories.begin(), kShapeCategories.end()},
                    {"1", "category", "names in the order of the logits"});
  WriteSizes(file, net.net.sizes());
  file.WriteString("precision", training.precision, {"", "", "of the training: f32 or bf16"});
  for (const ParamBlock& block : net.layout.blocks()) {
    const auto begin = net.params.begin() + block.offset;
    file.Write("weights/" + block.name, std::vector<float>(begin, begin + block.size()),
               {block.rows, block.cols}, {"1", "output, input", "y = W x + b"});
  }
  WriteCurve(file, training.curve);
  WriteTrial(file, training.held_out);
  file.Commit();
}

ShapeNet ReadShapeNet(const std::string& path) {
  const H5Reader file(path, kShapeNetFormat);
  const std::vector<std::string> categories = file.ReadStrings("categories");
  const std::vector<std::string> expected(kShapeCategories.begin(), kShapeCategories.end());
  if (categories != expected)
    Fail("{}: categories: expected {}, found {}", path, fmt::join(expected, " "),
         fmt::join(categories, " "));
  const PointNetSizes sizes = ReadSizes(file);
  try {
    sizes.Check();
  } catch (const Error& error) {
    Fail("{}: {}", path, error.what());
  }
  ShapeNet net(sizes);
  for (const ParamBlock& block : net.layout.blocks()) {
    const auto values = file.ReadValues<float>("weights/" + block.name, {block.rows, block.cols});
    for (const float value : values)
      if (!std::isfinite(value))
        Fail("{}: weights/{}: expected finite values, found {}", path, block.name, value);
    std::copy(values.begin(), values.end(), net.params.begin() + block.offset);
  }
  return net;
}

void WriteShape(const std::string& path, const ShapeDescriptor& descriptor,
                const Provenance& provenance) {
  H5Writer file(path, kShapeFormat, provenance);
  file.Write("feature", descriptor.feature, {kDescriptorSize},
             {"1", "component", "p, the PointNet++ descriptor of the shape"});
  file.Write("logits", descriptor.logits, {static_cast<std::int64_t>(kShapeCategories.size())},
             {"1", "category", "scores of airplane, animal, head, shoe, train, vehicle"});
  file.Write("probabilities", CategoryProbabilities(descriptor),
             {static_cast<std::int64_t>(kShapeCategories.size())},
             {"1", "category", "softmax of the logits: the category without a label"});
  file.Commit();
}

ShapeDescriptor ReadShape(const std::string& path) {
  const H5Reader file(path, kShapeFormat);
  ShapeDescriptor descriptor;
  descriptor.feature = file.ReadValues<float>("feature", {kDescriptorSize});
  descriptor.logits =
      file.ReadValues<float>("logits", {static_cast<std::int64_t>(kShapeCategories.size())});
  for (const float value : descriptor.feature)
    if (!std::isfinite(value)) Fail("{}: feature: expected finite values, found {}", path, value);
  return descriptor;
}

std::string CurveCsv(const ShapeCurve& curve) {
  CsvWriter csv({"epoch", "rate", "loss", "train_accuracy", "held_out_accuracy"});
  for (std::size_t i = 0; i < curve.epoch.size(); ++i)
    csv.Row({fmt::format("{}", curve.epoch[i]), fmt::format("{:.6g}", curve.rate[i]),
             fmt::format("{:.6g}", curve.loss[i]), fmt::format("{:.6g}", curve.train_accuracy[i]),
             fmt::format("{:.6g}", curve.held_out_accuracy[i])});
  return csv.text();
}

}  // namespace dexremoe
