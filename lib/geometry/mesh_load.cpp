#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cstring>
#include <filesystem>

#include "base/error.h"
#include "geometry/mesh_io.h"
#include "geometry/ply.h"
#include "geometry/repair.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

std::string LowerExtension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

// What the file says its size is, so that a file cut short is noticed even where the reader
// underneath makes do with what is left. Zero where the format does not say.
std::size_t PromisedBytes(const std::string& extension, const std::string& bytes) {
  std::uint32_t word = 0;
  if (extension == ".stl" && bytes.size() >= 84 && bytes.compare(0, 5, "solid") != 0) {
    std::memcpy(&word, bytes.data() + 80, sizeof(word));
    return 84 + 50 * static_cast<std::size_t>(word);
  }
  if (extension == ".glb" && bytes.size() >= 12) std::memcpy(&word, bytes.data() + 8, sizeof(word));
  return word;
}

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
                const Eigen::Matrix4d& parent, TriMesh& mesh) {
  const Eigen::Matrix4d transform = parent * ToEigen(node.mTransformation);
  for (unsigned i = 0; i < node.mNumMeshes; ++i)
    AppendMesh(path, *scene.mMeshes[node.mMeshes[i]], transform, mesh);
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    AppendNode(path, scene, *node.mChildren[i], transform, mesh);
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

TriMesh LoadMesh(const std::string& path) {
  const std::string bytes = ReadFile(path);
  if (bytes.empty()) Fail("{}: expected a mesh, found an empty file", path);
  const std::string extension = LowerExtension(path);
  // Assimp 5.2 misreads binary PLY whose first data byte looks like a line end.
  if (extension == ".ply") return Weld(ParsePly(path, bytes), 0);
  const std::size_t promised = PromisedBytes(extension, bytes);
  if (bytes.size() < promised)
    Fail("{}: file is truncated: expected {} bytes, found {}", path, promised, bytes.size());

  Assimp::Importer importer;
  if (!importer.IsExtensionSupported(extension))
    Fail("{}: expected a mesh file (obj, stl, ply, off, dae, fbx, gltf, glb), found '{}'", path,
         extension);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene == nullptr || scene->mRootNode == nullptr)
    Fail("{}: not a readable mesh: {}", path, OneLine(importer.GetErrorString()));
  CheckIndices(path, *scene);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr)
    Fail("{}: not a readable mesh: {}", path, OneLine(importer.GetErrorString()));
  TriMesh mesh;
  AppendNode(path, *scene, *scene->mRootNode, Eigen::Matrix4d::Identity(), mesh);
  if (mesh.triangles.empty()) Fail("{}: expected at least one face, found none", path);
  return Weld(mesh, 0);
}

}  // namespace dexremoe
