#include "geometry/mesh_import.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

#include "base/error.h"

namespace dexremoe {
namespace {

Eigen::Matrix4d ToEigen(const aiMatrix4x4& m) {
  Eigen::Matrix4d result;
  result << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2,
      m.d3, m.d4;
  return result;
}

void AppendMesh(const std::string& path, const aiMesh& source, const Eigen::Matrix4d& transform,
                TriMesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  const bool mirrored = transform.topLeftCorner<3, 3>().determinant() < 0;
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    const aiVector3D& v = source.mVertices[i];
    const Eigen::Vector3d p = (transform * Eigen::Vector4d(v.x, v.y, v.z, 1)).head<3>();
    if (!p.allFinite())
      Fail("{}: vertex {}: expected finite coordinates, found ({}, {}, {})", path, i, v.x, v.y,
           v.z);
    mesh.vertices.push_back(p);
  }
  for (unsigned i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices != 3) continue;  // points and lines
    std::array<int, 3> triangle;
    for (int k = 0; k < 3; ++k) triangle[k] = first + static_cast<int>(face.mIndices[k]);
    if (mirrored) std::swap(triangle[1], triangle[2]);
    mesh.triangles.push_back(triangle);
  }
}

void AppendNode(const std::string& path, const aiScene& scene, const aiNode& node,
                const Eigen::Matrix4d& parent, int max_triangles, TriMesh& mesh) {
  const Eigen::Matrix4d transform = parent * ToEigen(node.mTransformation);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    AppendMesh(path, *scene.mMeshes[node.mMeshes[i]], transform, mesh);
    // Instances multiply: a small file may stand for a large scene.
    if (mesh.triangles.size() > static_cast<std::size_t>(max_triangles))
      Fail("{}: expected at most {} triangles, found more", path, max_triangles);
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    AppendNode(path, scene, *node.mChildren[i], transform, max_triangles, mesh);
}

// Assimp's own triangulation trusts the indices, and a damaged file would crash it.
void CheckIndices(const std::string& path, const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned i = 0; i < mesh.mNumFaces; ++i)
      for (unsigned k = 0; k < mesh.mFaces[i].mNumIndices; ++k)
        if (mesh.mFaces[i].mIndices[k] >= mesh.mNumVertices)
          Fail("{}: face {}: expected vertex indices below {}, found {} (truncated or damaged?)",
               path, i, mesh.mNumVertices, mesh.mFaces[i].mIndices[k]);
  }
}

std::string OneLine(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

}  // namespace

bool IsImportable(const std::string& extension) {
  return Assimp::Importer().IsExtensionSupported(extension);
}

TriMesh ImportMesh(const std::string& path, int max_triangles) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene == nullptr || scene->mRootNode == nullptr)
    Fail("{}: not a readable mesh: {}", path, OneLine(importer.GetErrorString()));
  CheckIndices(path, *scene);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr)
    Fail("{}: not a readable mesh: {}", path, OneLine(importer.GetErrorString()));
  TriMesh mesh;
  AppendNode(path, *scene, *scene->mRootNode, Eigen::Matrix4d::Identity(), max_triangles, mesh);
  if (mesh.triangles.empty()) Fail("{}: expected at least one face, found none", path);
  return mesh;
}

}  // namespace dexremoe
