#include "shape/training.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/log.h"
#include "nn/adam.h"
#include "nn/kernels.h"
#include "nn/layers.h"
#include "nn/precision.h"

namespace dexremoe {
namespace {

// Clouds that share a gradient buffer; a fixed number, so that sums do not depend on the workers.
constexpr int kCloudsPerChunk = 2;
constexpr int kSumChunks = 16;
// Clouds that the initial weights are normalised on.
constexpr int kInitialClouds = 48;

// First index of the kAugment streams.
enum AugmentUse : std::uint64_t { kForTraining = 0, kForTrial = 1, kForStart = 2 };

struct Sample {
  int object = 0, view = 0;
};

struct SampleResult {
  double loss = 0;
  bool right = false;
};

// Means over an epoch's clouds.
struct EpochResult {
  double loss = 0, accuracy = 0;
};

// T is what weights and activations are stored in; the weights that Adam moves are net.params.
template <typename T>
class Trainer {
 public:
  Trainer(const std::vector<LabelledCloud>& clouds, const ShapeTrainOptions& options,
          std::uint64_t seed, ThreadPool& pool, ShapeNet& net)
      : clouds_(clouds),
        options_(options),
        seed_(seed),
        pool_(pool),
        net_(net),
        stored_(net.params.size()),
        workspaces_(pool.workers()),
        chunk_grads_((options.batch + kCloudsPerChunk - 1) / kCloudsPerChunk),
        grads_(net.params.size()) {}

  // Initial weights, normalised on variants of the objects in turn.
  void Initialize() {
    std::vector<GroupedCloud> grouped;
    for (int i = 0; i < kInitialClouds; ++i) {
      const int object = i % static_cast<int>(clouds_.size());
      grouped.push_back(Variant(kForStart, 0, {object, i}));
    }
    Rng rng(seed_, Stream::kInit);
    net_.net.Initialize(rng, grouped, net_.params.data());
    Store();
  }

  EpochResult RunEpoch(int epoch, double rate) {
    const std::vector<Sample> samples = Shuffled(epoch);
    std::vector<SampleResult> results(samples.size());
    for (std::size_t i = 0; i < samples.size(); i += options_.batch) {
      const std::size_t count = std::min<std::size_t>(options_.batch, samples.size() - i);
      Step(epoch, rate, {samples.data() + i, count}, results.data() + i);
    }
    EpochResult means;
    for (const SampleResult& result : results) {
      means.loss += result.loss / static_cast<double>(results.size());
      means.accuracy += result.right / static_cast<double>(results.size());
    }
    return means;
  }

 private:
  // The epoch's clouds in random order. Objects take turns from where the last epoch stopped.
  std::vector<Sample> Shuffled(int epoch) const {
    const std::int64_t count = options_.epoch_clouds, first = count * epoch;
    const auto objects = static_cast<std::int64_t>(clouds_.size());
    std::vector<Sample> samples;
    for (std::int64_t i = first; i < first + count; ++i)
      samples.push_back({static_cast<int>(i % objects), static_cast<int>(i / objects)});
    Rng rng(seed_, Stream::kShuffle, {static_cast<std::uint64_t>(epoch)});
    for (std::size_t i = samples.size(); i > 1; --i)
      std::swap(samples[i - 1], samples[rng.Index(i)]);
    return samples;
  }

  // One step of Adam on `batch`; results stand in its order.
  void Step(int epoch, double rate, std::span<const Sample> batch, SampleResult* results) {
    const int count = static_cast<int>(batch.size());
    const int chunks = (count + kCloudsPerChunk - 1) / kCloudsPerChunk;
    pool_.ParallelFor(chunks, [&](int chunk, int worker) {
      const int begin = chunk * kCloudsPerChunk, end = std::min(begin + kCloudsPerChunk, count);
      chunk_grads_[chunk].assign(net_.params.size(), 0.0f);
      RunChunk(epoch, batch.subspan(begin, end - begin), 1.0f / static_cast<float>(count),
               workspaces_[worker], chunk_grads_[chunk].data(), results + begin);
    });
    SumGradients(chunks);
    const double norm = ClipGradient(options_.max_norm, grads_);
    if (!std::isfinite(norm))
      Fail("train_shape: the gradient is not finite in epoch {}; try a lower shape.rate", epoch);
    AdamStep({}, rate, grads_, adam_, net_.params);
    Store();
  }

  void Store() {
    Cast(static_cast<std::int64_t>(stored_.size()), net_.params.data(), stored_.data());
  }

  GroupedCloud Variant(AugmentUse use, int epoch, const Sample& sample) const {
    Rng rng(seed_, Stream::kAugment,
            {use, static_cast<std::uint64_t>(epoch), static_cast<std::uint64_t>(sample.object),
             static_cast<std::uint64_t>(sample.view)});
    return net_.net.Group(AugmentCloud(clouds_[sample.object].points, options_.augment, rng));
  }

  void RunChunk(int epoch, std::span<const Sample> samples, float weight,
                PointNetWorkspace<T>& work, float* grads, SampleResult* results) const {
    std::vector<GroupedCloud> grouped;
    for (const Sample& sample : samples) grouped.push_back(Variant(kForTraining, epoch, sample));
    net_.net.Forward<T>(stored_.data(), grouped, work);
    const int k = net_.net.sizes().categories;
    std::vector<float> dlogits(samples.size() * k);
    SoftmaxForward<float>(static_cast<std::int64_t>(samples.size()), k, work.logits.data(),
                          dlogits.data());
    // Cross-entropy of the softmax: its gradient is the probabilities minus the label's one.
    for (std::size_t i = 0; i < samples.size(); ++i) {
      float* row = dlogits.data() + i * k;
      const int label = clouds_[samples[i].object].category;
      results[i].loss = -std::log(std::max(row[label], 1e-30f));
      results[i].right = std::max_element(row, row + k) == row + label;
      row[label] -= 1;
      for (int j = 0; j < k; ++j) row[j] *= weight;
    }
    net_.net.Backward<T>(stored_.data(), grouped, dlogits.data(), work, grads);
  }

  // grads_ = sum of the chunks' gradients, in chunk order; parallel over ranges of parameters.
  void SumGradients(int chunks) {
    const std::size_t size = grads_.size();
    pool_.ParallelFor(kSumChunks, [&](int range, int) {
      const std::size_t begin = size * range / kSumChunks, end = size * (range + 1) / kSumChunks;
      std::copy(chunk_grads_[0].begin() + begin, chunk_grads_[0].begin() + end,
                grads_.begin() + begin);
      for (int c = 1; c < chunks; ++c)
        for (std::size_t i = begin; i < end; ++i) grads_[i] += chunk_grads_[c][i];
    });
  }

  const std::vector<LabelledCloud>& clouds_;
  const ShapeTrainOptions& options_;
  std::uint64_t seed_;
  ThreadPool& pool_;
  ShapeNet& net_;
  std::vector<T> stored_;  // net_.params as of the last step
  std::vector<PointNetWorkspace<T>> workspaces_;
  std::vector<std::vector<float>> chunk_grads_;
  std::vector<float> grads_;
  AdamState adam_;
};

double RateOf(const ShapeTrainOptions& options, int epoch) {
  const int decays = epoch * (options.decays + 1) / options.epochs;
  return options.rate * std::pow(options.decay, decays);
}

template <typename T>
ShapeTraining Train(const LabelledClouds& clouds, const ShapeTrainOptions& options,
                    std::uint64_t seed, ThreadPool& pool, ShapeNet& net) {
  Trainer<T> trainer(clouds.train, options, seed, pool, net);
  trainer.Initialize();
  ShapeTraining training;
  ShapeCurve& curve = training.curve;
  Progress progress("train_shape", options.epochs);
  for (int epoch = 0; epoch < options.epochs; ++epoch) {
    const double rate = RateOf(options, epoch);
    const EpochResult result = trainer.RunEpoch(epoch, rate);
    const bool try_now = (epoch + 1) % options.evaluate_every == 0 || epoch + 1 == options.epochs;
    if (try_now) training.held_out = TryShapes(net, clouds.held_out, options.rotations, seed, pool);
    curve.epoch.push_back(epoch + 1);
    curve.rate.push_back(rate);
    curve.loss.push_back(result.loss);
    curve.train_accuracy.push_back(result.accuracy);
    curve.held_out_accuracy.push_back(try_now ? training.held_out.Accuracy() : NAN);
    progress.Update(epoch + 1,
                    fmt::format("loss {:.3f}  right {:.0f} %", result.loss, 100 * result.accuracy));
  }
  progress.Finish();
  return training;
}

}  // namespace

void ShapeTrainOptions::Register(Options& registry) {
  registry.Add("shape.epochs", &epochs, "epochs, the steps of the learning curve").Range(1, 100000);
  registry
      .Add("shape.epoch_clouds", &epoch_clouds,
           "clouds in an epoch: random variants of the objects in turn")
      .Range(1, 1000000);
  registry.Add("shape.batch", &batch, "clouds per step").Range(1, 1024);
  registry.Add("shape.rate", &rate, "learning rate of Adam at the start").Range(1e-8, 1);
  registry.Add("shape.decay", &decay, "factor on the rate ...").Range(0.01, 1);
  registry.Add("shape.decays", &decays, "... applied so many times, evenly spread").Range(0, 1000);
  registry.Add("shape.max_norm", &max_norm, "bound on the gradient's norm").Range(1e-6, 1e6);
  registry.Add("shape.rotations", &rotations, "orientations a held-out object is tried in")
      .Range(1, 10000);
  registry.Add("shape.evaluate_every", &evaluate_every, "epochs between trials on held-out objects")
      .Range(1, 100000);
  registry
      .Add("shape.precision", &precision,
           "what the network trains in; auto: bf16 where the processor has it")
      .Choices({"auto", "f32", "bf16"});
  augment.Register(registry);
}

double ShapeTrial::Accuracy() const {
  if (accuracy.empty()) return NAN;
  return std::accumulate(accuracy.begin(), accuracy.end(), 0.0) /
         static_cast<double>(accuracy.size());
}

ShapeTrial TryShapes(const ShapeNet& net, const std::vector<LabelledCloud>& clouds, int rotations,
                     std::uint64_t seed, ThreadPool& pool) {
  const int categories = net.net.sizes().categories;
  ShapeTrial trial;
  trial.confusion.assign(categories * categories, 0);
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    std::vector<Eigen::Quaternionf> orientations;
    for (int r = 0; r < rotations; ++r) {
      Rng rng(seed, Stream::kAugment, {kForTrial, i, static_cast<std::uint64_t>(r)});
      const auto [w, x, y, z] = rng.UnitQuaternion();
      orientations.push_back(Eigen::Quaterniond(w, x, y, z).cast<float>());
    }
    int right = 0;
    for (const auto& d : DescribeRotated(net, clouds[i].points, orientations, pool)) {
      const auto best = std::max_element(d.logits.begin(), d.logits.end()) - d.logits.begin();
      right += best == clouds[i].category;
      ++trial.confusion[clouds[i].category * categories + best];
    }
    trial.names.push_back(clouds[i].name);
    trial.accuracy.push_back(static_cast<double>(right) / rotations);
  }
  return trial;
}

ShapeTraining TrainShape(const LabelledClouds& clouds, const ShapeTrainOptions& options,
                         std::uint64_t seed, ThreadPool& pool, ShapeNet& net) {
  const std::string precision = ResolvePrecision(options.precision);
  ShapeTraining training = precision == "bf16" ? Train<BFloat16>(clouds, options, seed, pool, net)
                                               : Train<float>(clouds, options, seed, pool, net);
  training.precision = precision;
  return training;
}

}  // namespace dexremoe
