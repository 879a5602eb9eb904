// Found in assimp 5.2: it overflows its stack on deep JSON and on deep trees of nodes, copies a node for each
// parent it has (n nodes make 2^n), reads positions of other types than float as if they were floats, and
// takes a stride below the size of an element. Spec: Khronos 2021, glTF 2.0, sections 3.5 to 3.7.
#include "datasets_gen/files/check_gltf.hpp"

#include <algorithm>
#include <cstring>

namespace treeline::datasets::files {
namespace {

constexpr std::size_t deepest_json = 200, deepest_node = 1000;
/// Corners of all copies of all meshes: 90 million triangles.
constexpr std::uint64_t most_corners = 1u << 28;

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

/// Extensions that a file needs are refused, but for those that leave positions and faces as they are, and
/// quantisation, which the check of the positions judges.
void check_extensions(const Input& in, const Json& root) {
  static constexpr std::string_view harmless[] = {"KHR_materials_", "KHR_texture_",         "EXT_texture_",
                                                  "MSFT_texture_",  "KHR_lights_",          "EXT_lights_",
                                                  "KHR_xmp",        "KHR_mesh_quantization"};
  const auto needed = root.find("extensionsRequired");
  if (needed == root.end()) return;
  if (!needed->is_array()) in.fail("extensionsRequired", "is no list of names");
  for (const Json& extension : *needed) {
    const auto name = extension.get<std::string>();
    if (std::ranges::none_of(harmless, [&](std::string_view start) { return name.starts_with(start); }))
      in.fail("extensionsRequired", "the file needs " + in_quotes(name) +
                                        ", which is not read here; export it without that extension");
  }
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

const Json& list(const Json& root, const char* key) {
  static const Json none = Json::array();
  const auto it = root.find(key);
  return it != root.end() && it->is_array() ? *it : none;
}

std::uint64_t component_size(std::uint64_t code) {
  static constexpr std::pair<std::uint64_t, std::uint64_t> sizes[] = {{5120, 1}, {5121, 1}, {5122, 2},
                                                                      {5123, 2}, {5125, 4}, {5126, 4}};
  for (const auto& [known, bytes] : sizes)
    if (known == code) return bytes;
  return 0;
}

void check_views(const Input& in, const Json& root) {
  const Json &views = list(root, "bufferViews"), &buffers = list(root, "buffers");
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
}

/// Elements of some size, one after the other in a view: `part` names who wants them.
void check_extent(const Input& in, const Json& root, const Json& part, const std::string& place,
                  std::uint64_t count, std::uint64_t size, std::uint64_t stride_least) {
  const Json& views = list(root, "bufferViews");
  const std::uint64_t view = at_or(part, "bufferView", views.size());
  if (view >= views.size()) in.fail(place, "names a bufferView that is not there");
  const std::uint64_t stride = at_or(views[view], "byteStride", stride_least);
  if (stride < stride_least) in.fail(place, "its bufferView's byteStride is below the size of an element");
  const std::uint64_t offset = at_or(part, "byteOffset", 0), length = at_or(views[view], "byteLength", 0);
  if (count > 0 &&
      (count > length / stride + 1 || offset > length || (count - 1) * stride + size > length - offset))
    in.fail(place, std::to_string(count) + " elements run past the end of its bufferView");
}

void check_accessors(const Input& in, const Json& root) {
  const Json& accessors = list(root, "accessors");
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    const Json& a = accessors[i];
    const std::string place = "accessor " + std::to_string(i);
    const std::uint64_t count = at_or(a, "count", 0);
    static constexpr std::pair<std::string_view, std::uint64_t> widths[] = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
    std::uint64_t width = 0;
    for (const auto& [name, components] : widths)
      if (a.value("type", "") == name) width = components;
    const std::uint64_t size = component_size(at_or(a, "componentType", 0)) * width;
    if (size == 0) in.fail(place, "has no known type");
    if (a.contains("bufferView"))
      check_extent(in, root, a, place, count, size, size);
    else if (count > in.bytes.size())
      in.fail(place, std::to_string(count) + " elements of zero, more than the file has bytes");
    if (!a.contains("sparse")) continue;
    const Json& sparse = a.at("sparse");
    const std::uint64_t changed = at_or(sparse, "count", 0);
    if (changed > count) in.fail(place, "has more sparse elements than elements");
    const std::uint64_t index = component_size(at_or(sparse.at("indices"), "componentType", 0));
    if (index == 0) in.fail(place, "has sparse indices of no known type");
    check_extent(in, root, sparse.at("indices"), place, changed, index, index);
    check_extent(in, root, sparse.at("values"), place, changed, size, size);
  }
}

/// Positions and indices of the types that assimp reads as they are meant. Returns corners by mesh.
std::vector<std::uint64_t> check_meshes(const Input& in, const Json& root) {
  const Json &accessors = list(root, "accessors"), &meshes = list(root, "meshes");
  std::vector<std::uint64_t> corners(meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const Json& primitives = meshes[m].at("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const std::string place = "mesh " + std::to_string(m) + ", primitive " + std::to_string(p);
      const auto accessor = [&](const Json& holder, const char* key) -> const Json& {
        const std::uint64_t i = at_or(holder, key, accessors.size());
        if (i >= accessors.size()) in.fail(place, std::string(key) + " names an accessor that is not there");
        return accessors[i];
      };
      const Json& attributes = primitives[p].at("attributes");
      if (!attributes.contains("POSITION")) in.fail(place, "has no positions");
      const Json& position = accessor(attributes, "POSITION");
      if (position.value("type", "") != "VEC3" || at_or(position, "componentType", 0) != 5126)
        in.fail(place, "its positions are no triples of float; others (quantised ones) are not read");
      std::uint64_t most = at_or(position, "count", 0);
      if (primitives[p].contains("indices")) {
        const Json& indices = accessor(primitives[p], "indices");
        const std::uint64_t code = at_or(indices, "componentType", 0);
        if (indices.value("type", "") != "SCALAR" || (code != 5121 && code != 5123 && code != 5125))
          in.fail(place, "its indices are no unsigned integers");
        most = std::max(most, at_or(indices, "count", 0));
      }
      corners[m] += most;
    }
  }
  return corners;
}

/// Nodes must be trees: each has one parent at most. Returns how many nodes show each mesh.
std::vector<std::uint64_t> check_nodes(const Input& in, const Json& root, std::size_t meshes) {
  const Json& nodes = list(root, "nodes");
  std::vector<std::uint64_t> shown(meshes);
  std::vector<bool> has_parent(nodes.size());
  const auto name = [&](const Json& index, const std::string& by) {
    const std::uint64_t i = index.is_number_unsigned() ? index.get<std::uint64_t>() : nodes.size();
    if (i >= nodes.size()) in.fail(by, "names a node that is not there");
    if (has_parent[i]) in.fail(by, "names node " + std::to_string(i) + ", which has a parent already");
    return i;
  };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::string place = "node " + std::to_string(i);
    for (const Json& child : list(nodes[i], "children")) has_parent[name(child, place)] = true;
    for (const auto& [key, length] :
         {std::pair{"matrix", 16u}, {"translation", 3u}, {"rotation", 4u}, {"scale", 3u}})
      if (nodes[i].contains(key) && nodes[i].at(key).size() != length)
        in.fail(place, std::string(key) + " needs " + std::to_string(length) + " numbers");
    if (!nodes[i].contains("mesh")) continue;
    const std::uint64_t mesh = at_or(nodes[i], "mesh", meshes);
    if (mesh >= meshes) in.fail(place, "names a mesh that is not there");
    ++shown[mesh];
  }
  // Depth by walking down from what has no parent; where each has one, there is a cycle.
  std::vector<std::pair<std::uint64_t, std::size_t>> open;
  std::size_t reached = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!has_parent[i]) open.push_back({i, 1});
  while (!open.empty()) {
    const auto [i, depth] = open.back();
    open.pop_back();
    ++reached;
    if (depth > deepest_node)
      in.fail("node " + std::to_string(i), "lies more than " + std::to_string(deepest_node) + " nodes deep");
    for (const Json& child : list(nodes[i], "children"))
      open.push_back({child.get<std::uint64_t>(), depth + 1});
  }
  if (reached < nodes.size()) in.fail("nodes", "some are their own ancestors");
  const Json& scenes = list(root, "scenes");
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    std::vector<bool> named(nodes.size());
    for (const Json& index : list(scenes[s], "nodes")) {
      const std::string place = "scene " + std::to_string(s);
      const std::uint64_t i = name(index, place);
      if (named[i]) in.fail(place, "names node " + std::to_string(i) + " twice");
      named[i] = true;
    }
  }
  return shown;
}

/// Byte at which brackets are nested too deep, or none.
std::optional<std::size_t> too_deep(std::string_view json) {
  std::size_t depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (!in_text && (c == '[' || c == '{')) {
      if (++depth > deepest_json) return i;
    } else if (!in_text && depth > 0 && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string_view check_gltf_chunks(const Input& in) {
  const std::string_view json = json_of(in);
  if (const auto at = too_deep(json))
    in.fail("byte " + std::to_string(static_cast<std::size_t>(json.data() - in.bytes.data()) + *at),
            "its JSON is nested more than " + std::to_string(deepest_json) + " deep");
  return json;
}

void check_gltf(const Input& in, const Json& root) {
  if (!root.is_object()) in.fail("", "its JSON is no object");
  check_extensions(in, root);
  check_buffer_files(in, root);
  check_views(in, root);
  check_accessors(in, root);
  const std::vector<std::uint64_t> corners = check_meshes(in, root);
  const std::vector<std::uint64_t> shown = check_nodes(in, root, corners.size());
  double all = 0;
  for (std::size_t m = 0; m < corners.size(); ++m)
    all += static_cast<double>(corners[m]) * static_cast<double>(std::max<std::uint64_t>(shown[m], 1));
  if (all > static_cast<double>(most_corners))
    in.fail("", "its nodes show the meshes so often that they have more than " +
                    std::to_string(most_corners) + " corners");
}

}  // namespace treeline::datasets::files
