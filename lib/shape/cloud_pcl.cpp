#include <pcl/features/normal_3d.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "io/atomic_file.h"
#include "shape/cloud.h"
#include "shape/normals.h"

namespace dexremoe {
namespace {

pcl::PointCloud<pcl::PointXYZ>::Ptr PclPoints(const std::vector<Eigen::Vector3d>& points) {
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const Eigen::Vector3d& p : points)
    cloud->push_back(pcl::PointXYZ(static_cast<float>(p.x()), static_cast<float>(p.y()),
                                   static_cast<float>(p.z())));
  return cloud;
}

pcl::PointCloud<pcl::PointNormal> PclCloud(const PointCloud& cloud) {
  pcl::PointCloud<pcl::PointNormal> result;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    pcl::PointNormal point;
    point.getVector3fMap() = cloud.points[i].cast<float>();
    point.getNormalVector3fMap() = cloud.normals[i].cast<float>();
    point.curvature = 0;
    result.push_back(point);
  }
  return result;
}

}  // namespace

void FitNormals(const std::vector<Eigen::Vector3d>& surface, int neighbors, PointCloud& cloud) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(PclPoints(cloud.points));
  estimation.setSearchSurface(PclPoints(surface));
  estimation.setSearchMethod(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  estimation.setKSearch(std::min(neighbors, static_cast<int>(surface.size())));
  pcl::PointCloud<pcl::Normal> fitted;
  estimation.compute(fitted);
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    Eigen::Vector3d normal = fitted[i].getNormalVector3fMap().cast<double>();
    if (!normal.allFinite() || normal.squaredNorm() < 0.5) continue;
    normal.normalize();
    cloud.normals[i] = normal.dot(cloud.normals[i]) < 0 ? Eigen::Vector3d(-normal) : normal;
  }
}

void ExportCloud(const std::string& path, const PointCloud& cloud) {
  const std::string ending = std::filesystem::path(path).extension();
  if (ending != ".pcd" && ending != ".ply")
    Fail("{}: expected the ending .pcd or .ply, found '{}'", path, ending);
  const std::string temporary = PrepareTemporary(path);
  int status = -1;
  try {
    status = ending == ".pcd" ? pcl::PCDWriter().writeBinary(temporary, PclCloud(cloud))
                              : pcl::PLYWriter().write(temporary, PclCloud(cloud), true, false);
  } catch (const pcl::PCLException&) {
    status = -1;
  }
  if (status != 0) {
    std::filesystem::remove(temporary);
    Fail("{}: cannot be written", path);
  }
  CommitTemporary(temporary, path);
}

}  // namespace dexremoe
