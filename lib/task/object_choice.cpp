#include "task/object_choice.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "base/error.h"
#include "base/random.h"
#include "io/csv.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 8> kEndings = {".ply", ".obj", ".stl", ".off",
                                                 ".dae", ".fbx", ".glb", ".gltf"};

std::string Lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::vector<MeshFile> FromManifest(const fs::path& folder, const fs::path& manifest) {
  const CsvTable table = CsvTable::Read(manifest.string());
  const auto categories = table.Text("category"), files = table.Text("file");
  const auto classes =
      table.HasColumn("class") ? table.Text("class") : std::vector<std::string>(files.size());
  std::vector<MeshFile> meshes;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (std::find(kCategories.begin(), kCategories.end(), categories[i]) == kCategories.end())
      Fail("{}: category of {}: expected one of {}, found '{}'", manifest.string(), files[i],
           fmt::join(kCategories, ", "), categories[i]);
    const fs::path path = folder / files[i];
    if (!fs::is_regular_file(path))
      Fail("{}: file: expected '{}' to exist, found no such file", manifest.string(),
           path.string());
    meshes.push_back({categories[i], path.string(), classes[i]});
  }
  return meshes;
}

std::vector<MeshFile> FromFolders(const fs::path& folder) {
  std::vector<MeshFile> meshes;
  for (const char* category : kCategories) {
    if (!fs::is_directory(folder / category)) continue;
    for (const auto& entry : fs::directory_iterator(folder / category)) {
      const std::string ending = Lower(entry.path().extension().string());
      if (std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end())
        meshes.push_back({category, entry.path().string()});
    }
  }
  return meshes;
}

template <typename T>
void Shuffle(std::vector<T>& values, Rng rng) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[rng.Index(i)]);
}

std::string NameOf(const std::string& path) {
  std::string name = Lower(fs::path(path).stem().string());
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

// The drawn meshes of all categories, by category.
std::vector<ObjectEntry> Draw(const std::vector<MeshFile>& meshes, int per_category,
                              std::uint64_t seed) {
  std::vector<ObjectEntry> entries;
  for (int c = 0; c < kNumCategories; ++c) {
    std::vector<MeshFile> ours;
    for (const MeshFile& mesh : meshes)
      if (mesh.category == kCategories[c]) ours.push_back(mesh);
    Shuffle(ours, Rng(seed, Stream::kSplit, {0, static_cast<std::uint64_t>(c)}));
    if (per_category > 0 && static_cast<int>(ours.size()) > per_category) ours.resize(per_category);
    for (const MeshFile& mesh : ours) {
      ObjectEntry& entry = entries.emplace_back();
      entry.name = NameOf(mesh.path);
      entry.category = mesh.category;
      entry.mesh = mesh.path;
      entry.object_class = mesh.object_class;
    }
  }
  return entries;
}

void MakeNamesUnique(std::vector<ObjectEntry>& entries) {
  std::map<std::string, int> uses;
  for (const ObjectEntry& entry : entries) ++uses[entry.name];
  std::set<std::string> names;
  for (ObjectEntry& entry : entries) {
    if (uses[entry.name] > 1) entry.name = entry.category + "_" + entry.name;
    if (!names.insert(entry.name).second)
      Fail("{}: expected file names that differ within a category, found '{}' again", entry.mesh,
           entry.name);
  }
}

// NOTE(paper): the split is drawn over all objects, not per category; that every category keeps a
// training object is ours and only matters for small sets.
void Split(std::vector<ObjectEntry>& entries, double train_fraction, std::uint64_t seed) {
  std::vector<ObjectEntry*> order;
  std::map<std::string, int> left;  // training objects by category
  for (ObjectEntry& entry : entries) {
    entry.split = "train";
    order.push_back(&entry);
    ++left[entry.category];
  }
  Shuffle(order, Rng(seed, Stream::kSplit, {1}));
  const double rest = (1 - train_fraction) * static_cast<double>(entries.size());
  long ood = std::lround(rest);
  if (ood == 0 && train_fraction < 1) ood = 1;
  for (ObjectEntry* entry : order) {
    if (ood == 0) break;
    if (left[entry->category] == 1) continue;
    --left[entry->category];
    --ood;
    entry->split = "ood";
  }
}

}  // namespace

std::vector<MeshFile> ListMeshes(const std::string& folder) {
  if (!fs::is_directory(folder)) Fail("{}: expected a folder of meshes, found none", folder);
  const fs::path manifest = fs::path(folder) / "manifest.csv";
  std::vector<MeshFile> meshes =
      fs::exists(manifest) ? FromManifest(folder, manifest) : FromFolders(folder);
  if (meshes.empty())
    Fail(
        "{}: expected manifest.csv or CATEGORY/*.ply (obj, stl, off, dae, fbx, glb, gltf), found "
        "no mesh",
        folder);
  std::sort(meshes.begin(), meshes.end(), [](const MeshFile& a, const MeshFile& b) {
    return std::tie(a.category, a.path) < std::tie(b.category, b.path);
  });
  return meshes;
}

std::vector<ObjectEntry> ChooseObjects(const std::vector<MeshFile>& meshes,
                                       const ChoiceOptions& options, std::uint64_t seed) {
  std::vector<ObjectEntry> entries = Draw(meshes, options.per_category, seed);
  MakeNamesUnique(entries);
  std::sort(entries.begin(), entries.end(), [](const ObjectEntry& a, const ObjectEntry& b) {
    return std::tie(a.category, a.name) < std::tie(b.category, b.name);
  });
  Split(entries, options.train_fraction, seed);
  return entries;
}

std::string MakefileText(const std::vector<ObjectEntry>& entries) {
  std::string text;
  for (const ObjectEntry& e : entries) {
    if (e.mesh.find_first_of(" \t#$:%\\") != std::string::npos)
      Fail(
          "{}: expected a path without blanks and the characters # $ : % \\, which make cannot "
          "take",
          e.mesh);
    text += fmt::format("OBJECT_NAMES += {}\nMESH_{} := {}\nCATEGORY_{} := {}\n", e.name, e.name,
                        e.mesh, e.name, e.category);
  }
  return text;
}

}  // namespace dexremoe
