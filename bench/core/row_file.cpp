#include "bench/core/row_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "bench/core/environment.hpp"
#include "bench/core/options.hpp"

namespace treeline::bench {

RowFile::RowFile(const std::string& path, bool resume, const std::string& task) : path_(path) {
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
    read_existing(task);
  } catch (const std::exception& e) {
    refuse(e.what());
  }
}

RowFile::~RowFile() {
  if (file_ >= 0) close(file_);
}
RowFile::RowFile(RowFile&& o) noexcept
    : path_(std::move(o.path_)),
      other_build_(std::move(o.other_build_)),
      file_(std::exchange(o.file_, -1)),
      finished_(std::move(o.finished_)) {}
RowFile& RowFile::operator=(RowFile&& o) noexcept {
  std::swap(path_, o.path_), std::swap(other_build_, o.other_build_);
  std::swap(file_, o.file_), std::swap(finished_, o.finished_);
  return *this;
}

/// Throws for a row of another machine; of another build, remembers what is different.
void RowFile::check_origin(const nlohmann::ordered_json& row) {
  const auto& here = environment();
  const auto text = [](const nlohmann::ordered_json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
  };
  const auto differs = [&](const char* field) { return row.contains(field) && row[field] != here[field]; };
  for (const char* field : {"host", "cpu", "isa"})
    if (differs(field))
      throw std::runtime_error(
          fmt::format("it was measured elsewhere ({} '{}', here '{}'), and times of two "
                      "machines do not compare; choose another file, and merge them "
                      "afterwards",
                      field, text(row[field]), text(here[field])));
  if (!other_build_.empty()) return;
  for (const char* field : {"commit", "compiler", "flags"})
    if (differs(field))
      other_build_ += fmt::format("{}{} '{}', now '{}'", other_build_.empty() ? "" : "; ", field,
                                  text(row[field]), text(here[field]));
}

void RowFile::read_existing(const std::string& task) {
  std::ifstream in(path_, std::ios::binary);
  std::stringstream buffer;
  buffer << in.rdbuf();
  const std::string text = std::move(buffer).str();
  std::size_t start = 0, number = 1;
  const auto take = [&](std::string_view line) {
    try {
      const auto json = nlohmann::ordered_json::parse(line);
      const Row row = Row::from_json(json);
      if (row.task != task) throw std::runtime_error(fmt::format("it is of the task '{}'", row.task));
      check_origin(json);
      finished_.insert_or_assign(row.key(), row);
    } catch (const std::exception& e) {
      throw std::runtime_error(
          fmt::format("line {} is not a row of the task {} to continue: {}", number, task, e.what()));
    }
  };
  for (std::size_t end; (end = text.find('\n', start)) != std::string::npos; start = end + 1, ++number)
    take(std::string_view(text).substr(start, end - start));
  const std::string_view tail = std::string_view(text).substr(start);
  if (tail.empty()) return;
  if (nlohmann::ordered_json::accept(tail)) {
    take(tail);
    return write_all("\n");
  }
  const std::string head =
      fmt::format(R"({{"schema":{},"task":{})", Row::schema, nlohmann::ordered_json(task).dump());
  const std::size_t known = std::min(head.size(), tail.size());
  if (tail.substr(0, known) != head.substr(0, known))
    throw std::runtime_error(fmt::format("line {} is not the beginning of a row", number));
  if (ftruncate(file_, static_cast<off_t>(start)) != 0)
    throw std::runtime_error(fmt::format("cannot cut off its torn last line: {}", std::strerror(errno)));
}

const Row* RowFile::finished(const Row& cell) const {
  const auto found = finished_.find(cell.key());
  if (found == finished_.end()) return nullptr;
  const bool built_since = found->second.status == Status::not_built && cell.status != Status::not_built;
  return built_since ? nullptr : &found->second;
}

void RowFile::add(const Row& row) {
  if (file_ >= 0) write_all(row.to_line() + "\n");
}

void RowFile::write_all(const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(file_, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::system_error(errno, std::generic_category(), "writing rows to " + path_);
    done += static_cast<std::size_t>(n);
  }
}

}  // namespace treeline::bench
