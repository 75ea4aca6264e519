// Shares the training objects of an experiment out among experts.
#include <cstdio>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "task/object_groups.h"

int main(int argc, char** argv) {
  using namespace dexremoe;
  std::string objects, out;
  int groups = 6;
  Options options("group_objects",
                  "Shares the training objects out among experts, by category and, for more "
                  "experts than categories, by class: OUT1.csv, OUT2.csv, ...",
                  "group_objects --objects=objects.csv --groups=8 --out=ablation/objects_8_");
  options.Add("objects", &objects, "objects.csv").Required();
  options.Add("groups", &groups, "how many experts; 1: one of all objects").Range(1, 64);
  options.Add("out", &out, "paths without number and ending").Required().NotStored();
  return RunTool(options, argc, argv, [&] {
    const auto parts = GroupObjects(ReadObjectList(objects), groups);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      WriteObjectList(fmt::format("{}{}.csv", out, i + 1), parts[i]);
      std::string line = fmt::format("{}:", i + 1);
      for (const ObjectEntry& entry : parts[i]) line += " " + entry.name;
      std::puts(line.c_str());
    }
  });
}
