// Trains PointNet++ on the clouds of the training objects. A run takes minutes, so there is no
// checkpoint: one that is killed leaves no output and is started again.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "base/log.h"
#include "base/options.h"
#include "base/thread_pool.h"
#include "io/atomic_file.h"
#include "shape/shape_files.h"
#include "shape/training.h"

namespace {

void PrintTrial(const dexremoe::ShapeTrial& trial, int rotations) {
  for (std::size_t i = 0; i < trial.names.size(); ++i)
    std::printf("%-24s %5.1f %%\n", trial.names[i].c_str(), 100 * trial.accuracy[i]);
  if (trial.names.empty())
    std::printf("held-out accuracy: no objects of the split 'ood'\n");
  else
    std::printf("held-out accuracy: %.1f %% (%zu objects, %d orientations each)\n",
                100 * trial.Accuracy(), trial.names.size(), rotations);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("train_shape", "Trains the shape network to tell categories from point clouds.",
                  "train_shape --objects=objects.csv --out=shape_net.h5 --shape.epochs=40");
  std::string objects, out;
  std::uint64_t seed = 0;
  int workers = 0;
  PointNetSizes sizes;
  ShapeTrainOptions train;
  options.Add("objects", &objects, "objects.csv: name,category,split,mesh,folder,grasps")
      .Required();
  options.Add("out", &out, "network to write (shape_net.h5); the learning curve goes beside it")
      .Required()
      .NotStored();
  options.Add("seed", &seed, "random seed");
  options.Add("workers", &workers, "threads, 0 for all processors").Range(0, 1024).NotStored();
  sizes.Register(options);
  train.Register(options);
  return RunTool(options, argc, argv, [&] {
    const LabelledClouds clouds = ReadLabelledClouds(objects);
    std::vector<std::string> inputs = {objects};
    inputs.insert(inputs.end(), clouds.files.begin(), clouds.files.end());
    const Provenance provenance = MakeProvenance(options, seed, inputs);
    ThreadPool pool(workers);
    ShapeNet net(sizes);
    LogInfo("train_shape: {} training and {} held-out objects, {} parameters", clouds.train.size(),
            clouds.held_out.size(), net.params.size());
    const ShapeTraining training = TrainShape(clouds, train, seed, pool, net);
    const std::string csv = std::filesystem::path(out).replace_extension(".csv");
    WriteFile(csv, CurveCsv(training.curve));
    WriteShapeNet(out, net, training, provenance);
    PrintTrial(training.held_out, train.rotations);
    std::printf("training accuracy: %.1f %% of the last epoch's clouds\n",
                100 * training.curve.train_accuracy.back());
  });
}
