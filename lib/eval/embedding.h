// The map of the gate's weights (paper, section IV-D and figure 8): each object's cloud is turned,
// described anew and weighed by the gate; the weights are laid out by t-SNE.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/thread_pool.h"
#include "eval/tsne.h"
#include "io/h5.h"

namespace dexremoe {

inline constexpr H5Format kEmbeddingFormat{"dexremoe.embedding", 1};

struct EmbeddedObject {
  std::string name, category;
  int cluster = 0;      // of the mean log ratios, see EmbedWeights
  int expert = 0;       // the one with the largest mean weight
  double x = 0, y = 0;  // median position of its rows
};

struct Embedding {
  int experts = 0;
  std::vector<float> weight;             // [N, experts], rows sum to one
  std::vector<double> position;          // [N, 2]
  std::vector<std::int32_t> row_object;  // [N], index into objects
  std::vector<EmbeddedObject> objects;
  int clusters = 0;
  double silhouette = 0;  // of the clusters, -1 .. 1
  double kl = 0;          // nats
  double perplexity = 0;
  double neighbour_overlap = 0;  // share of the 10 nearest neighbours kept
  double trustworthiness = 0;
  int distinct = 0;  // rows that differ
};

// Centred log ratios (Aitchison 1982): the coordinates in which distances between compositions are
// Euclidean. weight [n, experts] -> [n, experts]; weights below 1e-6 count as 1e-6.
std::vector<double> LogRatios(const std::vector<float>& weight, int experts);

// Lays the rows out and clusters the objects. `objects` need name and category. Clusters come from
// k-means on each object's mean log ratios, with the number (2 .. 8) of the highest silhouette: not
// from the plane, where distances between groups mean nothing, and not from the largest weight
// alone, which ignores how a soft mixture mixes.
Embedding EmbedWeights(const std::vector<float>& weight, int experts,
                       const std::vector<std::int32_t>& row_object,
                       std::vector<EmbeddedObject> objects, const TsneOptions& options,
                       std::uint64_t seed, ThreadPool& pool,
                       const std::function<void(int done)>& progress = {});

void WriteEmbedding(const std::string& path, const Embedding& embedding,
                    const Provenance& provenance);
Embedding ReadEmbedding(const std::string& path);

}  // namespace dexremoe
