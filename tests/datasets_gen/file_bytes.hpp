// Files as bytes in memory: small writers for the formats that the library only reads, for the tests of files
// and for their fuzzing.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>

#include "geometry/mesh.hpp"

namespace treeline::datasets {

template <class T>
std::string bytes_of(T value, bool big_endian = false) {
  char b[sizeof value];
  std::memcpy(b, &value, sizeof value);
  if (big_endian) std::reverse(b, b + sizeof value);
  return std::string(b, sizeof value);
}

inline std::string text_of(float x) {
  char b[32];
  return std::string(b, std::to_chars(b, b + sizeof b, x).ptr);
}

inline std::string ply_text(const geometry::Mesh3f& m) {
  std::string s =
      "ply\nformat ascii 1.0\ncomment made by a test\nelement vertex " + std::to_string(m.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face " +
      std::to_string(m.size()) + "\nproperty list uchar int vertex_index\nend_header\n";
  for (const auto& p : m.vertices) s += text_of(p[0]) + " " + text_of(p[1]) + " " + text_of(p[2]) + " 255\n";
  for (const auto& f : m.faces)
    s += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
  return s;
}
inline std::string ply_big_endian(const geometry::Mesh3f& m) {
  std::string s = "ply\nformat binary_big_endian 1.0\nelement vertex " + std::to_string(m.vertices.size()) +
                  "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                  std::to_string(m.size()) +
                  "\nproperty list uchar int vertex_indices\nproperty uchar flag\nend_header\n";
  for (const auto& p : m.vertices)
    for (int k = 0; k < 3; ++k) s += bytes_of(double{p[k]}, true);
  for (const auto& f : m.faces) {
    s += '\3';
    for (const auto v : f) s += bytes_of(v, true);
    s += '\1';
  }
  return s;
}
inline std::string off_text(const geometry::Mesh3f& m) {
  std::string s =
      "OFF # a comment\n\n" + std::to_string(m.vertices.size()) + " " + std::to_string(m.size()) + " 0\n";
  for (const auto& p : m.vertices)
    s += text_of(p[0]) + " " + text_of(p[1]) + " " + text_of(p[2]) + "\n# between\n";
  for (const auto& f : m.faces)
    s += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + " 255 0 0\n";
  return s;
}
inline std::string stl_binary(const geometry::Mesh3f& m) {
  std::string s = "solid by name only";
  s.resize(80);
  s += bytes_of(static_cast<std::uint32_t>(m.size()));
  for (std::size_t i = 0; i < m.size(); ++i) {
    const auto t = m.triangle(i);
    s += std::string(12, '\0') + bytes_of(t.a) + bytes_of(t.b) + bytes_of(t.c) + std::string(2, '\0');
  }
  return s;
}
inline std::string stl_text(const geometry::Mesh3f& m) {
  std::string s = "solid test\n";
  for (std::size_t i = 0; i < m.size(); ++i) {
    s += " facet normal 0 0 0\n  outer loop\n";
    const auto t = m.triangle(i);
    for (const auto& p : {t.a, t.b, t.c})
      s += "   vertex " + text_of(p[0]) + " " + text_of(p[1]) + " " + text_of(p[2]) + "\n";
    s += "  endloop\n endfacet\n";
  }
  return s + "endsolid test\n";
}

/// The geometry of a glTF file: positions, then indices.
inline std::string gltf_data(const geometry::Mesh3f& m) {
  std::string data;
  for (const auto& p : m.vertices) data += bytes_of(p);
  for (const auto& f : m.faces) data += bytes_of(f);
  return data;
}
/// Its JSON: one mesh under a node that moves it by `x` along the first axis; `uri` is its buffer's.
inline std::string gltf_json(const geometry::Mesh3f& m, float x, const std::string& uri) {
  const std::size_t points = m.vertices.size() * 12, bytes = points + m.size() * 12;
  const auto box = m.box();
  const auto triple = [](const auto& p) {
    return "[" + text_of(p[0]) + "," + text_of(p[1]) + "," + text_of(p[2]) + "]";
  };
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":[)" +
         text_of(x) + R"(,0,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)" +
         R"("buffers":[{"byteLength":)" + std::to_string(bytes) +
         (uri.empty() ? "" : R"(,"uri":")" + uri + "\"") + R"(}],"bufferViews":[)" +
         R"({"buffer":0,"byteLength":)" + std::to_string(points) + R"(},{"buffer":0,"byteOffset":)" +
         std::to_string(points) + R"(,"byteLength":)" + std::to_string(bytes - points) +
         R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" +
         std::to_string(m.vertices.size()) + R"(,"type":"VEC3","min":)" + triple(box.low) + R"(,"max":)" +
         triple(box.high) + R"(},{"bufferView":1,"componentType":5125,"count":)" +
         std::to_string(3 * m.size()) + R"(,"type":"SCALAR"}]})";
}
inline std::string glb_of(std::string json, const std::string& data) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t w) { return bytes_of(static_cast<std::uint32_t>(w)); };
  return "glTF" + word(2) + word(12 + 8 + json.size() + 8 + data.size()) + word(json.size()) + "JSON" + json +
         word(data.size()) + std::string("BIN\0", 4) + data;
}
inline std::string glb(const geometry::Mesh3f& m, float x = 0) {
  return glb_of(gltf_json(m, x, ""), gltf_data(m));
}
inline std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string r;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t w = 0;
    for (std::size_t k = 0; k < 3; ++k)
      w = w << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) r += i + k <= bytes.size() ? digits[w >> (18 - 6 * k) & 63] : '=';
  }
  return r;
}
/// A .gltf whose buffer stands in its text.
inline std::string gltf_text(const geometry::Mesh3f& m, float x = 0) {
  return gltf_json(m, x, "data:application/octet-stream;base64," + base64(gltf_data(m)));
}

}  // namespace treeline::datasets
