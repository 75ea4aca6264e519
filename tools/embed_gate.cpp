// Lays out the gate's weights of many turned clouds in the plane (paper, figure 8).
#include <cstdio>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "base/options.h"
#include "base/random.h"
#include "eval/embedding.h"
#include "rl/policy_file.h"
#include "rl/policy_runner.h"
#include "shape/cloud.h"
#include "shape/shape_files.h"
#include "task/object_set.h"

namespace {

using namespace dexremoe;

struct EmbedOptions {
  std::string gate, net, objects, split = "train", out;
  int rotations = 6000;
  std::uint64_t seed = 1;
  int workers = 0;
  TsneOptions tsne;

  void Register(Options& options) {
    options.Add("gate", &gate, "checkpoint of a gate").Required();
    options.Add("net", &net, "trained shape network (shape_net.h5)").Required();
    options.Add("objects", &objects, "objects.csv").Required();
    options.Add("split", &split, "which objects").Choices({"train", "ood", "all"});
    options.Add("rotations", &rotations, "turned clouds in all, shared evenly by the objects")
        .Range(8, 100000);
    options.Add("out", &out, "embedding to write (dexremoe.embedding)").Required().NotStored();
    options.Add("seed", &seed, "seed of the rotations, the layout and the clusters");
    options.Add("workers", &workers, "threads; 0 = all processors").NotStored();
    tsne.Register(options);
  }
};

std::vector<ObjectEntry> SelectEntries(const EmbedOptions& o) {
  std::vector<ObjectEntry> entries = ReadObjectList(o.objects);
  if (o.split != "all")
    std::erase_if(entries, [&](const ObjectEntry& entry) { return entry.split != o.split; });
  if (entries.empty()) Fail("{}: expected objects of split {}, found none", o.objects, o.split);
  return entries;
}

// Haar-uniform; rotation k of an object has its own stream.
std::vector<Eigen::Quaternionf> DrawRotations(std::uint64_t seed, std::uint64_t object, int count) {
  std::vector<Eigen::Quaternionf> rotations;
  for (int k = 0; k < count; ++k) {
    Rng rng(seed, Stream::kEmbed, {object, static_cast<std::uint64_t>(k)});
    const auto q = rng.UnitQuaternion();
    rotations.emplace_back(static_cast<float>(q[0]), static_cast<float>(q[1]),
                           static_cast<float>(q[2]), static_cast<float>(q[3]));
  }
  return rotations;
}

// What the gate's policy sees of a cloud in each orientation.
std::vector<std::vector<float>> Features(const EmbedOptions& o, const ObjectEntry& entry,
                                         const std::vector<Eigen::Quaternionf>& rotations,
                                         const ShapeNet& net, ThreadPool& pool) {
  std::vector<std::vector<float>> features;
  if (const int count = ReadPolicyStructure(o.gate).cloud_points; count > 0) {
    const std::vector<float> feature = PointsFeature(entry.folder, count);
    const Eigen::Map<const Eigen::Matrix3Xf> points(feature.data(), 3, count);
    for (const Eigen::Quaternionf& rotation : rotations) {
      const Eigen::Matrix3Xf turned = rotation.toRotationMatrix() * points;
      features.emplace_back(turned.data(), turned.data() + turned.size());
    }
    return features;
  }
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : ReadCloud(entry.folder + "/cloud.h5").points)
    points.push_back(p.cast<float>());
  for (ShapeDescriptor& d : DescribeRotated(net, points, rotations, pool))
    features.push_back(std::move(d.feature));
  return features;
}

// Features of all turned clouds, object by object.
struct Turned {
  std::vector<float> feature;
  std::vector<int> category;
  std::vector<std::int32_t> object;
  std::vector<EmbeddedObject> objects;
};

Turned DescribeAll(const EmbedOptions& o, const std::vector<ObjectEntry>& entries,
                   ThreadPool& pool) {
  const ShapeNet net = ReadShapeNet(o.net);
  Turned turned;
  Progress progress("descriptors", static_cast<double>(entries.size()));
  const int count = static_cast<int>(entries.size());
  for (int i = 0; i < count; ++i) {
    const int share = o.rotations / count + (i < o.rotations % count ? 1 : 0);
    const auto rotations = DrawRotations(o.seed, static_cast<std::uint64_t>(i), share);
    for (const std::vector<float>& feature : Features(o, entries[i], rotations, net, pool)) {
      turned.feature.insert(turned.feature.end(), feature.begin(), feature.end());
      turned.category.push_back(CategoryIndex(entries[i].category));
      turned.object.push_back(i);
    }
    turned.objects.push_back({.name = entries[i].name, .category = entries[i].category});
    progress.Update(i + 1);
  }
  return turned;
}

void Run(const EmbedOptions& o, const Options& options) {
  const auto entries = SelectEntries(o);
  if (o.rotations < static_cast<int>(entries.size()))
    Fail("--rotations: expected at least one for each of {} objects, found {}", entries.size(),
         o.rotations);
  std::vector<std::string> inputs = {o.gate, o.net, o.objects};
  for (const ObjectEntry& entry : entries) inputs.push_back(entry.folder + "/cloud.h5");
  const Provenance provenance = MakeProvenance(options, o.seed, inputs);
  ThreadPool pool(o.workers);
  const PolicyRunner runner(o.gate, {}, pool);
  if (runner.gates() < 2)
    Fail("{}: expected a mixture with a gate, found kind {}", o.gate, runner.kind());
  const Turned turned = DescribeAll(o, entries, pool);
  Progress progress("t-SNE", o.tsne.iterations);
  const Embedding map =
      EmbedWeights(runner.WeightsOf(turned.feature, turned.category), runner.gates(), turned.object,
                   turned.objects, o.tsne, o.seed, pool, [&](int done) { progress.Update(done); });
  progress.Finish();
  WriteEmbedding(o.out, map, provenance);
  std::printf("%zu rows of %zu objects (%d distinct), %d experts\n", map.row_object.size(),
              map.objects.size(), map.distinct, map.experts);
  std::printf("KL %.4f nats, perplexity %.3g\n", map.kl, map.perplexity);
  std::printf("10-neighbour overlap %.3f, trustworthiness %.4f\n", map.neighbour_overlap,
              map.trustworthiness);
  std::printf("%d clusters of objects, silhouette %.2f\n", map.clusters, map.silhouette);
}

}  // namespace

int main(int argc, char** argv) {
  EmbedOptions embed;
  dexremoe::Options options(
      "embed_gate",
      "Turns each object's cloud, describes it anew, weighs the experts by the gate and lays the "
      "weights out by t-SNE.",
      "embed_gate --gate=gate.h5 --net=shape_net.h5 --objects=objects.csv --out=tsne.h5");
  embed.Register(options);
  return dexremoe::RunTool(options, argc, argv, [&] { Run(embed, options); });
}
