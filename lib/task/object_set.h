// The objects of an experiment: which they are (objects.csv) and what the stages before made of
// them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/pose.h"
#include "sim/batch_sim.h"

namespace dexremoe {

// The paper's six categories, in the order of the one-hot vector.
inline constexpr std::array<const char*, 6> kCategories = {"airplane", "animal", "head",
                                                           "shoe",     "train",  "vehicle"};
inline constexpr int kNumCategories = 6;
inline constexpr int kShapeFeatureSize = 100;  // p, the PointNet++ descriptor (paper, III-B)

// Index of a category; throws Error listing the six names.
int CategoryIndex(const std::string& name);

// One line of objects.csv: name,category,class,split,mesh,folder,grasps; class may be missing.
// Paths are relative to the working directory.
struct ObjectEntry {
  std::string name;
  std::string category;
  std::string split;              // "train" or "ood" (out of distribution)
  std::string mesh;               // source mesh
  std::string folder;             // holds mesh.h5, parts.h5, cloud.h5, shape.h5
  std::string grasps;             // grasps.h5
  std::string object_class = {};  // finer than the category; may be empty
};
std::vector<ObjectEntry> ReadObjectList(const std::string& path);
void WriteObjectList(const std::string& path, const std::vector<ObjectEntry>& entries);

// A stable grasp: start of an episode.
struct Grasp {
  std::vector<double> q;       // joint angles, rad
  std::vector<double> target;  // servo targets, rad
  Pose X_WO;                   // object pose
  double scale = 1;            // size factor it was found with
};

struct TaskObject {
  std::string name;
  int category = 0;
  std::string split;
  SimObject sim;
  double mass = 0;  // nominal, kg
  // Descriptor [kShapeFeatureSize], or points [3 * ObjectSetNeeds::cloud_points]; empty when not
  // loaded.
  std::vector<float> feature;
  // [kNumCategories] what policies see of the category; empty: the label, one-hot.
  std::vector<float> category_input;
  std::vector<Grasp> grasps;  // empty when not loaded
};

// mesh.h5 and parts.h5 alone, for stages before shape.h5 and the grasps exist. Throws Error.
TaskObject LoadSimObject(const std::string& mesh_path, const std::string& parts_path);

struct ObjectSetNeeds {
  bool feature = true;
  bool grasps = true;
  int cloud_points = 0;  // above 0, the feature is not the descriptor but so many points
};
// The first `count` points of FOLDER/cloud.h5, which are the farthest from each other, with the
// whole cloud scaled to the unit sphere: x, y, z of each. Throws Error when there are fewer.
std::vector<float> PointsFeature(const std::string& folder, int count);
// Reads mesh.h5 and parts.h5 of every entry, shape.h5 or cloud.h5 and the grasps where needed.
// Throws Error naming the file that is missing or wrong.
std::vector<TaskObject> LoadObjects(const std::vector<ObjectEntry>& entries,
                                    const ObjectSetNeeds& needs);

}  // namespace dexremoe
