#include "bench/core/truth_cache.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <filesystem>
#include <fstream>

namespace treeline::bench {
namespace {

namespace fs = std::filesystem;

struct Header {
  char magic[8] = {'t', 'r', 'e', 'e', 't', 'r', 'u', '1'};
  std::uint64_t dataset_hash = 0, query_hash = 0;
  std::int64_t version = 0;
  std::uint64_t size = 0;
  std::uint64_t checksum = 0;
  bool operator==(const Header&) const = default;
};

Header header_of(const TruthKey& key, std::span<const std::byte> blob) {
  Header h;
  h.dataset_hash = key.dataset_hash, h.query_hash = key.query_hash, h.version = key.version;
  h.size = blob.size();
  h.checksum = XXH3_64bits(blob.data(), blob.size());
  return h;
}

fs::path path_of(const std::string& folder, const TruthKey& key) {
  return fs::path(folder) /
         fmt::format("{}-v{}-{:016x}-{:016x}.truth", key.task, key.version, key.dataset_hash, key.query_hash);
}

}  // namespace

std::optional<std::vector<std::byte>> load_truth(const std::string& folder, const TruthKey& key) {
  if (folder.empty()) return std::nullopt;
  const fs::path path = path_of(folder, key);
  std::error_code error;
  const std::uintmax_t file_size = fs::file_size(path, error);
  if (error || file_size < sizeof(Header)) return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  Header header;
  std::vector<std::byte> blob(file_size - sizeof(Header));
  in.read(reinterpret_cast<char*>(&header), sizeof header);
  in.read(reinterpret_cast<char*>(blob.data()), static_cast<std::streamsize>(blob.size()));
  if (!in || header != header_of(key, blob)) return std::nullopt;
  return blob;
}

bool store_truth(const std::string& folder, const TruthKey& key, std::span<const std::byte> blob) {
  if (folder.empty()) return false;
  std::error_code error;
  fs::create_directories(folder, error);
  const fs::path path = path_of(folder, key);
  fs::path beside = path;
  beside += fmt::format(".{}", getpid());
  {
    std::ofstream out(beside, std::ios::binary);
    const Header header = header_of(key, blob);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(reinterpret_cast<const char*>(blob.data()), static_cast<std::streamsize>(blob.size()));
    out.close();
    if (out) fs::rename(beside, path, error);
    if (out && !error) return true;
  }
  fs::remove(beside, error);
  return false;
}

}  // namespace treeline::bench
