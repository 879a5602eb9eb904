// Truth on disk: computed once, found again under the dataset's hash, the queries' hash and the task's
// version.
//
// A cache only: what cannot be read or written is computed anew, and a damaged file counts as absent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace treeline::bench {

struct TruthKey {
  std::string task;  // or task and part, e.g. "knn_within"; letters, digits, '_' and '-'
  int version = 0;
  std::uint64_t dataset_hash = 0, query_hash = 0;
};

/// Empty if there is none, the folder name is empty, or the file is damaged.
std::optional<std::vector<std::byte>> load_truth(const std::string& folder, const TruthKey&);
/// Writes beside and renames, so that readers see all or nothing. False if it could not be written.
bool store_truth(const std::string& folder, const TruthKey&, std::span<const std::byte>);

template <class T>
requires std::is_trivially_copyable_v<T> std::optional<std::vector<T>> load_truth_as(
    const std::string& folder, const TruthKey& key) {
  const auto blob = load_truth(folder, key);
  if (!blob || blob->size() % sizeof(T) != 0) return std::nullopt;
  std::vector<T> out(blob->size() / sizeof(T));
  if (!out.empty()) std::memcpy(out.data(), blob->data(), blob->size());
  return out;
}

template <class T>
requires std::is_trivially_copyable_v<T>
bool store_truth(const std::string& folder, const TruthKey& key, const std::vector<T>& truth) {
  return store_truth(folder, key, std::as_bytes(std::span(truth)));
}

}  // namespace treeline::bench
