#include "task/object_set.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "geometry/object_files.h"
#include "io/atomic_file.h"
#include "io/csv.h"
#include "shape/cloud.h"
#include "shape/grouping.h"
#include "shape/shape_files.h"
#include "task/grasp_file.h"

namespace dexremoe {
namespace {

SimObject MakeSimObject(const ObjectMesh& mesh, ObjectParts parts) {
  SimObject object;
  object.name = mesh.name;
  object.parts = std::move(parts.parts);
  object.unit_inertia = mesh.inertia / mesh.mass;
  for (const TriMesh& part : object.parts)
    for (const Eigen::Vector3d& p : part.vertices)
      object.radius = std::max(object.radius, p.norm());
  return object;
}

std::vector<float> DescriptorFeature(const std::string& folder) {
  const std::string path = folder + "/shape.h5";
  std::vector<float> feature = ReadShape(path).feature;
  if (feature.size() != kShapeFeatureSize)
    Fail("{}: feature: expected {} values, found {}", path, kShapeFeatureSize, feature.size());
  return feature;
}

TaskObject LoadObject(const ObjectEntry& entry, const ObjectSetNeeds& needs) {
  TaskObject object = LoadSimObject(entry.folder + "/mesh.h5", entry.folder + "/parts.h5");
  object.name = object.sim.name = entry.name;
  object.category = CategoryIndex(entry.category);
  object.split = entry.split;
  if (needs.feature)
    object.feature = needs.cloud_points > 0 ? PointsFeature(entry.folder, needs.cloud_points)
                                            : DescriptorFeature(entry.folder);
  if (needs.grasps) {
    object.grasps = ReadGrasps(entry.grasps).grasps;
    if (object.grasps.empty())
      Fail("{}: joint_position: expected grasps, found none", entry.grasps);
  }
  return object;
}

}  // namespace

std::vector<float> PointsFeature(const std::string& folder, int count) {
  const std::string path = folder + "/cloud.h5";
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : ReadCloud(path).points) points.push_back(p.cast<float>());
  if (std::ssize(points) < count)
    Fail("{}: points: expected at least {}, found {}", path, count, points.size());
  points = ToUnitSphere(points);
  std::vector<float> feature;
  for (int i = 0; i < count; ++i) feature.insert(feature.end(), points[i].begin(), points[i].end());
  return feature;
}

int CategoryIndex(const std::string& name) {
  for (int i = 0; i < kNumCategories; ++i)
    if (name == kCategories[i]) return i;
  Fail("category: expected one of {}, found '{}'", fmt::join(kCategories, ", "), name);
}

std::vector<ObjectEntry> ReadObjectList(const std::string& path) {
  const CsvTable table = CsvTable::Read(path);
  const auto name = table.Text("name"), category = table.Text("category"),
             split = table.Text("split"), mesh = table.Text("mesh"), folder = table.Text("folder"),
             grasps = table.Text("grasps");
  const auto object_class =
      table.HasColumn("class") ? table.Text("class") : std::vector<std::string>(table.num_rows());
  std::vector<ObjectEntry> entries;
  std::set<std::string> names;
  for (std::size_t i = 0; i < table.num_rows(); ++i) {
    if (!names.insert(name[i]).second)
      Fail("{}: name: expected every name once, found '{}' again", path, name[i]);
    if (split[i] != "train" && split[i] != "ood")
      Fail("{}: split of {}: expected train or ood, found '{}'", path, name[i], split[i]);
    if (std::find(kCategories.begin(), kCategories.end(), category[i]) == kCategories.end())
      Fail("{}: category of {}: expected one of {}, found '{}'", path, name[i],
           fmt::join(kCategories, ", "), category[i]);
    entries.push_back(
        {name[i], category[i], split[i], mesh[i], folder[i], grasps[i], object_class[i]});
  }
  if (entries.empty()) Fail("{}: expected objects, found none", path);
  return entries;
}

void WriteObjectList(const std::string& path, const std::vector<ObjectEntry>& entries) {
  CsvWriter csv({"name", "category", "class", "split", "mesh", "folder", "grasps"});
  for (const ObjectEntry& e : entries)
    csv.Row({e.name, e.category, e.object_class, e.split, e.mesh, e.folder, e.grasps});
  WriteFile(path, csv.text());
}

TaskObject LoadSimObject(const std::string& mesh_path, const std::string& parts_path) {
  const ObjectMesh mesh = ReadObjectMesh(mesh_path);
  TaskObject object;
  object.name = mesh.name;
  object.mass = mesh.mass;
  object.sim = MakeSimObject(mesh, ReadParts(parts_path));
  return object;
}

std::vector<TaskObject> LoadObjects(const std::vector<ObjectEntry>& entries,
                                    const ObjectSetNeeds& needs) {
  std::vector<TaskObject> objects;
  for (const ObjectEntry& entry : entries) objects.push_back(LoadObject(entry, needs));
  return objects;
}

}  // namespace dexremoe
