// glTF 2 (.gltf, .glb) through assimp; all meshes of the scene, in place.
//
// The nodes are walked here: assimp's own step (PreTransformVertices, 5.2) leaves the faces of mirrored nodes
// looking inward, while glTF 2.0, section 3.7.4, turns them around where a node's determinant is negative.
// Checked first (check_gltf.cpp), because assimp trusts much of it; what it then read is counted.
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <bit>
#include <numeric>

#include "datasets_gen/files/check_gltf.hpp"

namespace treeline::datasets::files {
namespace {

/// glTF splits vertices where normals or texture coordinates jump; one position becomes one vertex again, so
/// that closed surfaces are found closed. Faces keep their order.
void weld(Raw& r) {
  std::vector<std::uint32_t> order(r.points.size()), first(r.points.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    const auto& p = r.points[i];
    return std::array{std::bit_cast<std::uint64_t>(p[0]), std::bit_cast<std::uint64_t>(p[1]),
                      std::bit_cast<std::uint64_t>(p[2])};
  };
  std::ranges::sort(order, [&](auto a, auto b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && key(order[k]) == key(order[k - 1]) ? first[order[k - 1]] : order[k];
  std::vector<std::uint32_t> renamed(r.points.size());
  std::size_t kept = 0;
  for (std::uint32_t i = 0; i < first.size(); ++i)
    if (first[i] == i) renamed[i] = static_cast<std::uint32_t>(kept), r.points[kept++] = r.points[i];
  if (kept == first.size()) return;
  r.notes.push_back("merged " + std::to_string(first.size() - kept) + " vertices at equal positions");
  r.points.resize(kept);
  for (auto& face : r.faces)
    for (auto& v : face) v = renamed[first[v]];
}

/// assimp leaves out a triangle that names a vertex which is not there, and says nothing. Before it changes
/// anything it has one mesh for each primitive, in their order.
void check_triangles(const Input& in, const Json& root, const aiScene& scene) {
  const auto meshes = root.find("meshes");
  if (meshes == root.end() || !meshes->is_array()) return;
  unsigned number = 0;
  for (std::size_t m = 0; m < meshes->size(); ++m) {
    const Json& primitives = (*meshes)[m].at("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p, ++number) {
      if (number >= scene.mNumMeshes) return;
      const Json& primitive = primitives[p];
      const std::uint64_t mode = at_or(primitive, "mode", 4);
      if (mode < 4 || primitive.contains("extensions")) continue;  // points and lines, or compressed
      const Json& accessors = root.at("accessors");
      const std::uint64_t none = accessors.size();
      const std::uint64_t corners =
          at_or(primitive, "indices", at_or(primitive.at("attributes"), "POSITION", none));
      if (corners >= accessors.size()) continue;
      const std::uint64_t count = at_or(accessors[corners], "count", 0);
      const std::uint64_t triangles = mode == 4 ? count / 3 : count > 2 ? count - 2 : 0;
      if (scene.mMeshes[number]->mNumFaces < triangles)
        in.fail("mesh " + std::to_string(m) + ", primitive " + std::to_string(p),
                std::to_string(triangles - scene.mMeshes[number]->mNumFaces) + " of " +
                    std::to_string(triangles) + " triangles name a vertex that is not there");
    }
  }
}

using Transform = aiMatrix4x4t<double>;

/// Appends one mesh as one node shows it; returns how many points and lines it left out. Positions are
/// rounded to float before they are welded: parts that meet in the file's scene meet here, too.
std::size_t add_mesh(const Input& in, const aiScene& scene, unsigned number, const Transform& transform,
                     Raw& r) {
  const aiMesh& mesh = *scene.mMeshes[number];
  const std::size_t first = r.points.size();
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& p = mesh.mVertices[i];
    const auto placed = transform * aiVector3t<double>(double(p.x), double(p.y), double(p.z));
    geometry::Vec3d& point = r.points.emplace_back(geometry::Vec3d{placed.x, placed.y, placed.z});
    for (int k = 0; k < 3; ++k) {
      if (beyond_float(point[k])) continue;  // refused with the other formats' ones
      const double rounded = double(static_cast<float>(point[k]));
      if (std::isfinite(rounded)) r.rounded = std::max(r.rounded, std::abs(rounded - point[k]));
      point[k] = rounded;
    }
  }
  const bool mirrored = transform.Determinant() < 0;
  std::size_t left_out = 0;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) {
      ++left_out;
      continue;
    }
    std::array<std::uint32_t, 3> corners;
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices)
        in.fail(
            "mesh " + std::to_string(number) + ", face " + std::to_string(i),
            "names vertex " + std::to_string(face.mIndices[k]) + " of " + std::to_string(mesh.mNumVertices));
      corners[k] = static_cast<std::uint32_t>(first) + face.mIndices[k];
    }
    if (mirrored) std::swap(corners[1], corners[2]);
    r.faces.push_back(corners);
  }
  return left_out;
}

}  // namespace

Raw read_assimp(const Input& in) {
  Json root;
  try {
    root = Json::parse(check_gltf_chunks(in));
    check_gltf(in, root);
  } catch (const Json::exception& e) {
    in.fail("", std::string("its JSON is broken: ") + e.what());
  }

  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(in.path.string(), 0);
  if (scene != nullptr) try {
      check_triangles(in, root, *scene);
    } catch (const Json::exception& e) {
      in.fail("", std::string("its JSON is broken: ") + e.what());
    }
  if (scene != nullptr) scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr) in.fail("", std::string("assimp cannot read it: ") + importer.GetErrorString());
  if (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) in.fail("", "assimp read it only in part");

  Raw r;
  std::size_t points_and_lines = 0;
  std::vector<std::pair<const aiNode*, Transform>> open;
  if (scene->mRootNode != nullptr) open.push_back({scene->mRootNode, Transform()});
  while (!open.empty()) {
    const auto [node, parent] = open.back();
    open.pop_back();
    const Transform here = parent * Transform(node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes; ++m)
      points_and_lines += add_mesh(in, *scene, node->mMeshes[m], here, r);
    for (unsigned c = node->mNumChildren; c > 0; --c) open.push_back({node->mChildren[c - 1], here});
  }
  r.is_mesh = true;
  weld(r);
  if (points_and_lines > 0)
    r.notes.push_back("left out " + std::to_string(points_and_lines) +
                      " points and lines: only triangles are read");
  return r;
}

}  // namespace treeline::datasets::files
