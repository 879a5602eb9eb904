// The file of rows: append only, one process at a time, each row on disk when add() returns.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "bench/core/row.hpp"

namespace treeline::bench {

class RowFile {
 public:
  /// No file: rows are only counted as finished.
  RowFile() = default;
  /// Throws UsageError if the file is not empty and not to be resumed, is in use, or holds anything but rows
  /// of this task; it is left as it is then. Of a last line without an end, as a killed run leaves it, a
  /// whole row gets its end and a torn one is cut off. Rows of another machine are not continued: a block's
  /// times compare only where they were measured together.
  RowFile(const std::string& path, bool resume, const std::string& task);
  ~RowFile();
  RowFile(RowFile&&) noexcept;
  RowFile& operator=(RowFile&&) noexcept;

  /// What differs between this program and the one that wrote the rows (commit, compiler, flags); empty:
  /// nothing.
  const std::string& other_build() const { return other_build_; }

  /// The row of this cell if an earlier run wrote it. That it was not built then does not count if it is now.
  const Row* finished(const Row& cell) const;
  /// Throws std::system_error if it cannot be written in full.
  void add(const Row&);

 private:
  void read_existing(const std::string& task);
  void check_origin(const nlohmann::ordered_json& row);
  void write_all(const std::string& text);

  std::string path_, other_build_;
  int file_ = -1;
  std::unordered_map<std::string, Row> finished_;
};

}  // namespace treeline::bench
