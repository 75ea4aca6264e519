// What tools and sections of configuration files are called.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace dexremoe {

// Every section that a configuration file may have beside the tools' own names. A section outside
// both lists is an error; a section that this tool does not use is left to the tools that do.
inline constexpr std::array<std::string_view, 16> kSections = {
    "load", "scale",  "decompose", "cloud", "shape", "hand", "sim",  "grasp",
    "task", "random", "policy",    "ppo",   "adr",   "eval", "tsne", "render"};
inline constexpr std::array<std::string_view, 30> kTools = {
    "make_objects",   "scale_mesh",     "decompose",    "sample_cloud",
    "train_shape",    "describe_shape", "hand_info",    "find_grasps",
    "train_base",     "train_expert",   "train_gate",   "train_baseline",
    "export_weights", "evaluate",       "tabulate",     "list_methods",
    "embed_gate",     "plot",           "render",       "h5_info",
    "h5_diff",        "mesh_info",      "list_objects", "group_objects",
    "rank_objects",   "bench_sim",      "validate_sim", "bench_decompose",
    "bench_learn",    "bench_shape"};

template <typename List>
bool Contains(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

}  // namespace dexremoe
