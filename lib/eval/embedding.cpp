#include "eval/embedding.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "eval/neighbours.h"

namespace dexremoe {
namespace {

constexpr int kNeighbours = 10;
constexpr int kMostClusters = 8;

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Mean log ratios [O, experts] over the rows of each object.
std::vector<double> ObjectMeans(const std::vector<double>& ratios, int experts,
                                const std::vector<std::int32_t>& row_object, int objects) {
  std::vector<double> mean(static_cast<std::size_t>(objects) * experts, 0.0);
  std::vector<int> count(objects, 0);
  for (std::size_t row = 0; row < row_object.size(); ++row) {
    ++count[row_object[row]];
    for (int e = 0; e < experts; ++e)
      mean[row_object[row] * experts + e] += ratios[row * experts + e];
  }
  for (int o = 0; o < objects; ++o) {
    if (count[o] == 0) Fail("embedding: object {}: expected at least one row, found none", o);
    for (int e = 0; e < experts; ++e) mean[o * experts + e] /= count[o];
  }
  return mean;
}

void PlaceObjects(Embedding& map) {
  for (std::size_t o = 0; o < map.objects.size(); ++o) {
    std::vector<double> x, y, weight(map.experts, 0.0);
    for (std::size_t row = 0; row < map.row_object.size(); ++row) {
      if (map.row_object[row] != static_cast<int>(o)) continue;
      x.push_back(map.position[2 * row]);
      y.push_back(map.position[2 * row + 1]);
      for (int e = 0; e < map.experts; ++e) weight[e] += map.weight[row * map.experts + e];
    }
    map.objects[o].x = Median(x);
    map.objects[o].y = Median(y);
    map.objects[o].expert =
        static_cast<int>(std::max_element(weight.begin(), weight.end()) - weight.begin());
  }
}

}  // namespace

std::vector<double> LogRatios(const std::vector<float>& weight, int experts) {
  std::vector<double> ratios(weight.size());
  for (std::size_t row = 0; row * experts < weight.size(); ++row) {
    double mean = 0;
    for (int e = 0; e < experts; ++e) {
      ratios[row * experts + e] = std::log(std::max(1e-6, double{weight[row * experts + e]}));
      mean += ratios[row * experts + e] / experts;
    }
    for (int e = 0; e < experts; ++e) ratios[row * experts + e] -= mean;
  }
  return ratios;
}

Embedding EmbedWeights(const std::vector<float>& weight, int experts,
                       const std::vector<std::int32_t>& row_object,
                       std::vector<EmbeddedObject> objects, const TsneOptions& options,
                       std::uint64_t seed, ThreadPool& pool,
                       const std::function<void(int)>& progress) {
  DEX_CHECK_EQ(weight.size(), row_object.size() * static_cast<std::size_t>(experts));
  const int n = static_cast<int>(row_object.size());
  const std::vector<double> ratios = LogRatios(weight, experts);
  const TsneResult tsne = Tsne(ratios, n, experts, options, seed, pool, progress);
  Embedding map;
  map.experts = experts;
  map.weight = weight;
  map.position = tsne.position;
  map.row_object = row_object;
  map.objects = std::move(objects);
  map.kl = tsne.kl;
  map.perplexity = tsne.perplexity;
  map.distinct = tsne.distinct;
  const int k = std::min(kNeighbours, (n - 1) / 2);
  const NeighbourPreservation kept = ComparePositions(ratios, n, experts, map.position, 2, k, pool);
  map.neighbour_overlap = kept.overlap;
  map.trustworthiness = kept.trustworthiness;
  const int count = static_cast<int>(map.objects.size());
  const Clustering clusters = ClusterPoints(ObjectMeans(ratios, experts, row_object, count), count,
                                            experts, kMostClusters, seed);
  map.clusters = clusters.clusters;
  map.silhouette = clusters.silhouette;
  for (int o = 0; o < count; ++o) map.objects[o].cluster = clusters.label[o];
  PlaceObjects(map);
  return map;
}

void WriteEmbedding(const std::string& path, const Embedding& map, const Provenance& provenance) {
  H5Writer file(path, kEmbeddingFormat, provenance);
  const auto rows = static_cast<std::int64_t>(map.row_object.size());
  const auto count = static_cast<std::int64_t>(map.objects.size());
  std::vector<std::string> name, category;
  std::vector<std::int32_t> cluster, expert;
  std::vector<double> place;
  for (const EmbeddedObject& object : map.objects) {
    name.push_back(object.name);
    category.push_back(object.category);
    cluster.push_back(object.cluster);
    expert.push_back(object.expert);
    place.insert(place.end(), {object.x, object.y});
  }
  file.Write("weight", map.weight, {rows, map.experts}, {"1", "row, expert", "gate weights"});
  file.Write("position", map.position, {rows, 2}, {"1", "row, axis", "place in the plane"});
  file.Write("row_object", map.row_object, {rows}, {"1", "row", "index into object/name"});
  file.WriteStrings("object/name", name, {"", "object", "name in objects.csv"});
  file.WriteStrings("object/category", category, {"", "object", "category"});
  file.Write("object/cluster", cluster, {count}, {"1", "object", "cluster of mean log ratios"});
  file.Write("object/expert", expert, {count}, {"1", "object", "expert of largest mean weight"});
  file.Write("object/position", place, {count, 2}, {"1", "object, axis", "median of its rows"});
  file.WriteScalar<std::int32_t>("clusters", map.clusters, {"1", "", "number of clusters"});
  file.WriteScalar("silhouette", map.silhouette, {"1", "", "mean silhouette of the clusters"});
  file.WriteScalar("kl", map.kl, {"nat", "", "KL(P || Q) of the layout"});
  file.WriteScalar("perplexity", map.perplexity, {"1", "", "as used"});
  file.WriteScalar("neighbour_overlap", map.neighbour_overlap,
                   {"1", "", "share of the 10 nearest neighbours kept"});
  file.WriteScalar("trustworthiness", map.trustworthiness,
                   {"1", "", "of 10 neighbours; 1 = none false, 0.5 = chance"});
  file.WriteScalar<std::int32_t>("distinct", map.distinct, {"1", "", "rows that differ"});
  file.Commit();
}

Embedding ReadEmbedding(const std::string& path) {
  const H5Reader file(path, kEmbeddingFormat);
  Embedding map;
  const auto weight = file.Read<float>("weight", {-1, -1});
  map.weight = weight.values;
  map.experts = static_cast<int>(weight.dims[1]);
  map.position = file.ReadValues<double>("position", {weight.dims[0], 2});
  map.row_object = file.ReadValues<std::int32_t>("row_object", {weight.dims[0]});
  const auto name = file.ReadStrings("object/name"), category = file.ReadStrings("object/category");
  const auto count = static_cast<std::int64_t>(name.size());
  const auto cluster = file.ReadValues<std::int32_t>("object/cluster", {count});
  const auto expert = file.ReadValues<std::int32_t>("object/expert", {count});
  const auto place = file.ReadValues<double>("object/position", {count, 2});
  if (category.size() != name.size())
    Fail("{}: dataset 'object/category': expected {} texts, found {}", path, count,
         category.size());
  for (const std::int32_t object : map.row_object)
    if (object < 0 || object >= count)
      Fail("{}: dataset 'row_object': expected 0 .. {}, found {}", path, count - 1, object);
  for (std::int64_t o = 0; o < count; ++o)
    map.objects.push_back(
        {name[o], category[o], cluster[o], expert[o], place[2 * o], place[2 * o + 1]});
  map.clusters = file.ReadScalar<std::int32_t>("clusters");
  map.silhouette = file.ReadScalar<double>("silhouette");
  map.kl = file.ReadScalar<double>("kl");
  map.perplexity = file.ReadScalar<double>("perplexity");
  map.neighbour_overlap = file.ReadScalar<double>("neighbour_overlap");
  map.trustworthiness = file.ReadScalar<double>("trustworthiness");
  map.distinct = file.ReadScalar<std::int32_t>("distinct");
  return map;
}

}  // namespace dexremoe
