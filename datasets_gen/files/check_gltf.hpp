// glTF 2, looked at before assimp gets it. Internal to the readers.
#pragma once

#include <nlohmann/json.hpp>

#include "datasets_gen/files/input.hpp"

namespace treeline::datasets::files {

using Json = nlohmann::json;

/// A member that is a natural number, or `otherwise`.
inline std::uint64_t at_or(const Json& object, const char* key, std::uint64_t otherwise) {
  const auto it = object.find(key);
  return it != object.end() && it->is_number_unsigned() ? it->get<std::uint64_t>() : otherwise;
}

/// The JSON text of a .gltf or .glb, not nested deeper than a parser's stack allows.
std::string_view check_gltf_chunks(const Input&);

/// Throws FileError where assimp would read past a buffer, recurse without end, make more of the file than
/// memory holds, or read other positions than the file's without a word; Json::exception for wrong types.
void check_gltf(const Input&, const Json& root);

}  // namespace treeline::datasets::files
