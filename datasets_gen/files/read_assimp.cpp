// glTF 2 (.gltf, .glb) through assimp; all meshes of the scene, in place.
//
// Checked first, because assimp trusts them: the chunks of a .glb against the file's size, and every accessor
// against its buffer, so that a header cannot make it allocate more than the file holds.
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

#include "datasets_gen/files/input.hpp"

namespace treeline::datasets::files {
namespace {

using Json = nlohmann::json;

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t w = 0;
  std::memcpy(&w, bytes.data() + at, 4);
  return w;
}

/// The JSON text of the file.
std::string_view json_of(const Input& in) {
  if (!in.bytes.starts_with("glTF")) return in.bytes;
  const auto fail = [&](std::size_t byte, const std::string& problem) {
    in.fail("byte " + std::to_string(byte), problem);
  };
  if (in.bytes.size() < 20) fail(in.bytes.size(), "the file ends within the header of a .glb");
  if (word_at(in.bytes, 4) != 2)
    fail(4, "glTF version " + std::to_string(word_at(in.bytes, 4)) + "; only 2 is read");
  if (word_at(in.bytes, 8) != in.bytes.size())
    fail(8, "promises " + std::to_string(word_at(in.bytes, 8)) + " bytes, and the file has " +
                std::to_string(in.bytes.size()));
  std::string_view json;
  for (std::size_t at = 12; at < in.bytes.size();) {
    if (in.bytes.size() - at < 8) fail(at, "the file ends within the header of a chunk");
    const std::size_t length = word_at(in.bytes, at);
    if (length > in.bytes.size() - at - 8)
      fail(at, "a chunk of " + std::to_string(length) + " bytes runs past the end");
    if (at == 12 && word_at(in.bytes, at + 4) != 0x4e4f534a) fail(at + 4, "the first chunk is not JSON");
    if (at == 12) json = std::string_view(in.bytes).substr(at + 8, length);
    at += 8 + length;
  }
  return json;
}

std::uint64_t at_or(const Json& object, const char* key, std::uint64_t otherwise) {
  const auto it = object.find(key);
  return it != object.end() && it->is_number_unsigned() ? it->get<std::uint64_t>() : otherwise;
}

/// Buffers in other files must lie in the folder of this one, or below it.
void check_buffer_files(const Input& in, const Json& root) {
  const auto buffers = root.find("buffers");
  if (buffers == root.end() || !buffers->is_array()) return;
  for (std::size_t i = 0; i < buffers->size(); ++i) {
    const std::string uri = (*buffers)[i].value("uri", "");
    if (uri.starts_with("data:")) continue;
    std::string name;
    for (std::size_t k = 0; k < uri.size(); ++k) {
      unsigned char code = 0;
      const char* digits = uri.data() + k + 1;
      if (uri[k] == '%' && k + 2 < uri.size() &&
          std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2)
        name += static_cast<char>(code), k += 2;
      else
        name += uri[k] == '\\' ? '/' : uri[k];
    }
    std::ranges::replace(name, '\\', '/');
    const auto path = std::filesystem::path(name).lexically_normal();
    const bool drive_or_scheme = name.substr(0, name.find('/')).find(':') != std::string::npos;
    if (path.is_absolute() || drive_or_scheme || (!path.empty() && *path.begin() == ".."))
      in.fail("buffer " + std::to_string(i), "is kept outside the folder of the file: " + in_quotes(uri));
  }
}

void check_accessors(const Input& in, const Json& root) {
  const auto list = [&](const char* key) -> const Json& {
    static const Json none = Json::array();
    const auto it = root.find(key);
    return it != root.end() && it->is_array() ? *it : none;
  };
  const Json &accessors = list("accessors"), &views = list("bufferViews"), &buffers = list("buffers");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::uint64_t buffer = at_or(views[i], "buffer", buffers.size());
    const auto fail = [&](const char* problem) { in.fail("bufferView " + std::to_string(i), problem); };
    if (buffer >= buffers.size()) fail("names a buffer that is not there");
    const std::uint64_t offset = at_or(views[i], "byteOffset", 0), length = at_or(views[i], "byteLength", 0);
    const std::uint64_t whole = at_or(buffers[buffer], "byteLength", 0);
    if (length > whole || offset > whole - length) fail("runs past the end of its buffer");
  }
  for (std::size_t i = 0; i < buffers.size(); ++i)
    if (!buffers[i].contains("uri") && at_or(buffers[i], "byteLength", 0) > in.bytes.size())
      in.fail("buffer " + std::to_string(i), "is longer than the file");
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    const Json& a = accessors[i];
    const auto fail = [&](const std::string& problem) { in.fail("accessor " + std::to_string(i), problem); };
    const std::uint64_t count = at_or(a, "count", 0);
    if (!a.contains("bufferView")) {
      if (count > in.bytes.size())
        fail(std::to_string(count) + " elements of zero, more than the file has bytes");
      continue;
    }
    const std::uint64_t view = at_or(a, "bufferView", views.size());
    if (view >= views.size()) fail("names a bufferView that is not there");
    static constexpr std::pair<std::uint64_t, std::uint64_t> sizes[] = {{5120, 1}, {5121, 1}, {5122, 2},
                                                                        {5123, 2}, {5125, 4}, {5126, 4}};
    static constexpr std::pair<std::string_view, std::uint64_t> widths[] = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
    std::uint64_t size = 0;
    for (const auto& [code, bytes] : sizes)
      if (code == at_or(a, "componentType", 0)) size = bytes;
    std::uint64_t width = 0;
    for (const auto& [name, components] : widths)
      if (a.value("type", "") == name) width = components;
    if (size * width == 0) fail("has no known type");
    const std::uint64_t stride = std::max(at_or(views[view], "byteStride", 0), size * width);
    const std::uint64_t offset = at_or(a, "byteOffset", 0), length = at_or(views[view], "byteLength", 0);
    if (count > 0 && (count > length / stride + 1 || offset > length ||
                      (count - 1) * stride + size * width > length - offset))
      fail(std::to_string(count) + " elements run past the end of its bufferView");
  }
}

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

}  // namespace

Raw read_assimp(const Input& in) {
  Json root;
  try {
    root = Json::parse(json_of(in));
    check_buffer_files(in, root);
    check_accessors(in, root);
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
  if (scene != nullptr)
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) in.fail("", std::string("assimp cannot read it: ") + importer.GetErrorString());
  if (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) in.fail("", "assimp read it only in part");

  Raw r;
  std::size_t points_and_lines = 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    const std::size_t first = r.points.size();
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& p = mesh.mVertices[i];
      r.points.push_back({p.x, p.y, p.z});
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) {
        ++points_and_lines;
        continue;
      }
      std::array<std::uint32_t, 3> corners;
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices)
          in.fail("mesh " + std::to_string(m) + ", face " + std::to_string(i),
                  "names vertex " + std::to_string(face.mIndices[k]) + " of " +
                      std::to_string(mesh.mNumVertices));
        corners[k] = static_cast<std::uint32_t>(first) + face.mIndices[k];
      }
      r.faces.push_back(corners);
    }
  }
  r.is_mesh = true;
  weld(r);
  if (points_and_lines > 0)
    r.notes.push_back("left out " + std::to_string(points_and_lines) +
                      " points and lines: only triangles are read");
  return r;
}

}  // namespace treeline::datasets::files
