// Which meshes of a folder take part in an experiment.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "task/object_set.h"

namespace dexremoe {

struct MeshFile {
  std::string category;
  std::string path;
  std::string object_class = {};  // empty when not said
};

// The meshes of a folder: those of manifest.csv (columns category, file, relative to the folder,
// and class, optional) when there is one, else
// FOLDER/CATEGORY/*.{ply,obj,stl,off,dae,fbx,glb,gltf}. By category, then by path. Throws Error
// when there are none, or naming the file and line that is wrong.
std::vector<MeshFile> ListMeshes(const std::string& folder);

struct ChoiceOptions {
  int per_category = 0;           // drawn from each category; 0 takes all
  double train_fraction = 0.667;  // of the objects; the rest is out of distribution
};

// Draws the objects and splits them (paper: 100 for training, 50 out of distribution). Every
// category keeps an object for training, for experts learn on categories; if train_fraction < 1 at
// least one object is left out wherever that allows it. mesh, name, category and split are filled;
// names are the file names with other characters than letters and digits as '_', with the category
// in front where two agree. Sorted by category and name. Throws Error.
std::vector<ObjectEntry> ChooseObjects(const std::vector<MeshFile>& meshes,
                                       const ChoiceOptions& options, std::uint64_t seed);

// The entries as a Makefile fragment: OBJECT_NAMES, and MESH_name, CATEGORY_name for each.
// Throws Error when a path holds characters that make cannot take.
std::string MakefileText(const std::vector<ObjectEntry>& entries);

}  // namespace dexremoe
