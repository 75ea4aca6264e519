// Draws the objects of an experiment from a folder of meshes and splits them.

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "base/options.h"
#include "io/atomic_file.h"
#include "task/object_choice.h"

namespace dexremoe {
namespace {

struct ListObjectsOptions {
  std::string meshes, out, folder = "data/objects", grasps, makefile;
  ChoiceOptions choice;
  std::uint64_t seed = 1;

  void Register(Options& options) {
    options.Add("meshes", &meshes, "folder with manifest.csv or CATEGORY/ folders").Required();
    options.Add("out", &out, "objects.csv to write").Required().NotStored();
    options.Add("per_category", &choice.per_category, "objects of each category; 0: all")
        .Range(0, 1e6);
    options.Add("train_fraction", &choice.train_fraction, "rest: out of distribution").Range(0, 1);
    options.Add("folder", &folder, "where the objects' files will stand: FOLDER/NAME/");
    options.Add("grasps", &grasps,
                "where grasps will stand: GRASPS/NAME.h5; empty: in FOLDER/NAME/");
    options.Add("makefile", &makefile, "Makefile fragment to write; empty: none").NotStored();
    options.Add("seed", &seed, "of all random numbers");
  }
};

void Run(const ListObjectsOptions& o) {
  std::vector<ObjectEntry> entries = ChooseObjects(ListMeshes(o.meshes), o.choice, o.seed);
  for (ObjectEntry& e : entries) {
    e.folder = o.folder + "/" + e.name;
    e.grasps = o.grasps.empty() ? e.folder + "/grasps.h5" : o.grasps + "/" + e.name + ".h5";
  }
  const std::string make = MakefileText(entries);
  WriteObjectList(o.out, entries);
  if (!o.makefile.empty()) WriteFile(o.makefile, make);
  for (const ObjectEntry& e : entries) fmt::print("{:<9} {:<5} {}\n", e.category, e.split, e.name);
  const auto train = std::count_if(entries.begin(), entries.end(),
                                   [](const ObjectEntry& e) { return e.split == "train"; });
  fmt::print("{} objects: {} train, {} ood\n", entries.size(), train, entries.size() - train);
}

}  // namespace
}  // namespace dexremoe

int main(int argc, char** argv) {
  using namespace dexremoe;
  Options options("list_objects", "Draws the objects of an experiment and splits them.",
                  "list_objects --meshes=meshes/builtin --per_category=2 --out=objects.csv");
  ListObjectsOptions o;
  o.Register(options);
  return RunTool(options, argc, argv, [&] { Run(o); });
}
