// Runs the fake benchmark program as a user would, and reads what it leaves.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "bench/core/row.hpp"

namespace treeline::bench {

using Json = nlohmann::ordered_json;

/// A folder of its own for each test, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "treeline_XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream buffer;
  buffer << in.rdbuf();
  return buffer.str();
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::stringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// Every line must be JSON; throws otherwise.
inline std::vector<Json> read_rows(const std::string& path) {
  std::vector<Json> out;
  for (const std::string& line : lines_of(read_text(path))) out.push_back(Json::parse(line));
  return out;
}

struct Finished {
  int status = -1;
  std::string out, err;
};

/// `setting` goes in front of the command, as "NAME=value …".
inline Finished run_fake(const std::string& arguments, const std::string& setting = "") {
  const TemporaryFolder folder;
  const std::string out = folder / "out", err = folder / "err";
  const std::string command =
      setting + " " FAKE_TASK " " + arguments + " >" + out + " 2>" + err + " </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
}

/// Few and short repetitions: what is tested here is not speed.
inline const std::string quickly = " --benchmark_min_time=0.001 --benchmark_repetitions=2 ";

/// The statuses that each method's rows have, by method.
inline std::map<std::string, std::map<std::string, int>> statuses_by_method(const std::vector<Json>& rows) {
  std::map<std::string, std::map<std::string, int>> out;
  for (const Json& row : rows) ++out[row["method"]][row["status"]];
  return out;
}

inline Json one_row(const std::vector<Json>& rows, const std::string& method) {
  for (const Json& row : rows)
    if (row["method"] == method) return row;
  return nullptr;
}

}  // namespace treeline::bench
