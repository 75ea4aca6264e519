#include <algorithm>

#include "base/error.h"
#include "io/csv.h"
#include "shape/cloud.h"
#include "shape/grouping.h"
#include "shape/training.h"

namespace dexremoe {
namespace {

int CategoryOf(const std::string& file, const std::string& object, const std::string& category) {
  const auto found = std::find(kShapeCategories.begin(), kShapeCategories.end(), category);
  if (found == kShapeCategories.end())
    Fail(
        "{}: category of '{}': expected airplane, animal, head, shoe, train or vehicle, found '{}'",
        file, object, category);
  return static_cast<int>(found - kShapeCategories.begin());
}

LabelledCloud ReadLabelledCloud(const std::string& folder, const std::string& name, int category) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : ReadCloud(folder + "/cloud.h5").points)
    points.push_back(p.cast<float>());
  return {name, category, ToUnitSphere(points), folder};
}

}  // namespace

LabelledClouds ReadLabelledClouds(const std::string& objects_csv) {
  const CsvTable table = CsvTable::Read(objects_csv);
  const auto names = table.Text("name"), categories = table.Text("category");
  const auto splits = table.Text("split"), folders = table.Text("folder");
  LabelledClouds clouds;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (splits[i] != "train" && splits[i] != "ood")
      Fail("{}: split of '{}': expected train or ood, found '{}'", objects_csv, names[i],
           splits[i]);
    clouds.files.push_back(folders[i] + "/cloud.h5");
    auto& set = splits[i] == "train" ? clouds.train : clouds.held_out;
    set.push_back(
        ReadLabelledCloud(folders[i], names[i], CategoryOf(objects_csv, names[i], categories[i])));
  }
  if (clouds.train.empty())
    Fail("{}: expected objects of the split 'train', found none in {} lines", objects_csv,
         names.size());
  return clouds;
}

}  // namespace dexremoe
