#include "bench/core/row_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "bench/core/options.hpp"

namespace treeline::bench {

RowFile::RowFile(const std::string& path, bool resume) : path_(path) {
  const auto refuse = [&](const std::string& why) {
    if (file_ >= 0) close(std::exchange(file_, -1));
    throw UsageError(fmt::format("--rows {}: {}", path, why));
  };
  file_ = open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) refuse(std::strerror(errno));
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) refuse("another run is writing to it");
  const off_t size = lseek(file_, 0, SEEK_END);
  if (size < 0) refuse("is not a file that can be continued");
  if (size == 0) return;
  if (!resume) refuse("exists already; choose another file, or --resume to continue it");
  try {
    read_existing();
  } catch (const std::exception& e) {
    refuse(e.what());
  }
}

RowFile::~RowFile() {
  if (file_ >= 0) close(file_);
}
RowFile::RowFile(RowFile&& o) noexcept
    : path_(std::move(o.path_)), file_(std::exchange(o.file_, -1)), finished_(std::move(o.finished_)) {}
RowFile& RowFile::operator=(RowFile&& o) noexcept {
  std::swap(path_, o.path_), std::swap(file_, o.file_), std::swap(finished_, o.finished_);
  return *this;
}

void RowFile::read_existing() {
  std::ifstream in(path_, std::ios::binary);
  std::stringstream buffer;
  buffer << in.rdbuf();
  const std::string text = std::move(buffer).str();
  std::size_t start = 0, number = 1;
  for (std::size_t end; (end = text.find('\n', start)) != std::string::npos; start = end + 1, ++number) {
    try {
      const Row row =
          Row::from_json(nlohmann::ordered_json::parse(text.begin() + static_cast<std::ptrdiff_t>(start),
                                                       text.begin() + static_cast<std::ptrdiff_t>(end)));
      finished_.insert_or_assign(row.key(), row);
    } catch (const std::exception& e) {
      throw std::runtime_error(fmt::format("line {} is not a row: {}", number, e.what()));
    }
  }
  if (start < text.size() && ftruncate(file_, static_cast<off_t>(start)) != 0)
    throw std::runtime_error(fmt::format("cannot cut off its torn last line: {}", std::strerror(errno)));
}

const Row* RowFile::finished(const std::string& key) const {
  const auto found = finished_.find(key);
  return found == finished_.end() ? nullptr : &found->second;
}

void RowFile::add(const Row& row) {
  if (file_ < 0) return;
  const std::string line = row.to_line() + "\n";
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t n = write(file_, line.data() + done, line.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::system_error(errno, std::generic_category(), "writing rows to " + path_);
    done += static_cast<std::size_t>(n);
  }
}

}  // namespace treeline::bench
