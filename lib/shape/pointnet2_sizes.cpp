#include <string>

#include "base/error.h"
#include "shape/pointnet2.h"

namespace dexremoe {
namespace {

void RegisterLevel(Options& options, const std::string& name, GroupSizes& sizes,
                   std::vector<int>& widths) {
  options.Add("shape." + name + "_centroids", &sizes.centroids, "centroids of " + name)
      .Range(1, 65536);
  options.Add("shape." + name + "_radius", &sizes.radius, "its ball, in unit-sphere units")
      .Range(1e-3, 2);
  options.Add("shape." + name + "_neighbors", &sizes.neighbors, "its points per ball at most")
      .Range(1, 65536);
  options.Add("shape." + name + "_widths", &widths, "widths of its network");
}

void CheckWidths(const char* name, const std::vector<int>& widths) {
  if (widths.empty()) Fail("shape.{}: expected at least one width, found none", name);
  for (const int width : widths)
    if (width < 1 || width > 65536)
      Fail("shape.{}: expected widths from 1 to 65536, found {}", name, width);
}

void CheckLevel(const char* name, const GroupSizes& sizes) {
  if (sizes.centroids < 1 || sizes.neighbors < 1 || !(sizes.radius > 0))
    Fail("shape.{}: expected positive sizes, found {} centroids, radius {}, {} neighbors", name,
         sizes.centroids, sizes.radius, sizes.neighbors);
}

}  // namespace

void PointNetSizes::Register(Options& options) {
  options.Add("shape.points", &points, "points of a cloud that enter").Range(16, 65536);
  RegisterLevel(options, "sa1", level1, widths1);
  RegisterLevel(options, "sa2", level2, widths2);
  options.Add("shape.sa3_widths", &widths3, "widths of the network over all centroids");
  options.Add("shape.head_widths", &head, "widths between there and the descriptor");
}

void PointNetSizes::Check() const {
  if (points < 4) Fail("shape.points: expected at least 4, found {}", points);
  CheckLevel("sa1", level1);
  CheckLevel("sa2", level2);
  if (level2.centroids > level1.centroids)
    Fail("shape.sa2_centroids: expected at most the {} of shape.sa1_centroids, found {}",
         level1.centroids, level2.centroids);
  CheckWidths("sa1_widths", widths1);
  CheckWidths("sa2_widths", widths2);
  CheckWidths("sa3_widths", widths3);
  CheckWidths("head_widths", head);
  if (feature < 1 || categories < 1)
    Fail("shape: expected positive sizes, found feature {}, categories {}", feature, categories);
}

}  // namespace dexremoe
