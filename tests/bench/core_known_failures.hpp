// The list of failures that are known, and how rows of hard cases are held against it.
#pragma once

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "bench/core/registry.hpp"
#include "bench/core/row.hpp"

namespace treeline::bench {

struct CellOfCase {
  std::string task, method, hard_case;
  auto operator<=>(const CellOfCase&) const = default;
};
using KnownFailures = std::map<CellOfCase, std::set<std::string>>;  // statuses allowed

/// One line's fields; quotes as in RFC 4180, but no line breaks inside them.
inline std::vector<std::string> split_csv(const std::string& line) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quoted && line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"')
      out.back() += line[i++];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      out.emplace_back();
    else
      out.back() += line[i];
  }
  if (quoted) throw std::invalid_argument("a quote is not closed");
  return out;
}

/// Throws std::invalid_argument naming file and line.
inline KnownFailures read_known_failures(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::invalid_argument(path + " cannot be read");
  KnownFailures out;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const auto refuse = [&](const std::string& why) {
      throw std::invalid_argument(path + ":" + std::to_string(number) + ": " + why);
    };
    if (number == 1) {
      if (line != "task,method,case,status,why") refuse("the first line must be task,method,case,status,why");
      continue;
    }
    if (line.empty()) continue;
    const auto fields = split_csv(line);
    if (fields.size() != 5) refuse("not five fields");
    if (fields[4].empty()) refuse("it does not say why");
    std::set<std::string> statuses;
    for (const std::string& word : split_names(fields[3], '|'))
      statuses.insert(std::string(to_string(status_from(word))));
    if (!out.emplace(CellOfCase{fields[0], fields[1], fields[2]}, statuses).second) refuse("listed twice");
  }
  return out;
}

inline std::string quoted_csv(const std::string& field) {
  std::string out = "\"";
  for (char c : field) out += c == '"' ? std::string("\"\"") : std::string(1, c == '\n' ? ' ' : c);
  return out + "\"";
}

/// What a cell found over all its query sets.
struct Found {
  Source source = Source::peer;
  std::map<std::string, std::string> failures;  // status → the first reason
  bool tried = false;                           // in some query set it ran
};

inline std::map<CellOfCase, Found> found_in(const std::vector<Row>& rows,
                                            const std::set<std::string>& may_refuse) {
  std::map<CellOfCase, Found> out;
  for (const Row& row : rows) {
    Found& found = out[{row.task, row.method, row.dataset}];
    found.source = row.source;
    const bool allowed = row.status == Status::ok || row.status == Status::unsupported ||
                         row.status == Status::not_built ||
                         (row.status == Status::refused && may_refuse.contains(row.dataset));
    if (row.status != Status::not_built && row.status != Status::unsupported) found.tried = true;
    if (!allowed)
      found.failures.try_emplace(std::string(to_string(row.status)), row.query_set + ": " + row.reason);
  }
  return out;
}

/// One line a problem; empty: all is as listed. Peers are only held against the list if `peers`.
inline std::vector<std::string> compare(const KnownFailures& known, const std::vector<Row>& rows,
                                        const std::set<std::string>& may_refuse, bool peers = true) {
  std::vector<std::string> out;
  std::set<std::string> tasks;
  for (const Row& row : rows) tasks.insert(row.task);
  const auto found = found_in(rows, may_refuse);
  const auto line_of = [](const CellOfCase& cell, const std::string& status, const std::string& why) {
    return cell.task + "," + cell.method + "," + cell.hard_case + "," + status + "," + quoted_csv(why);
  };
  for (const auto& [cell, what] : found) {
    const auto listed = known.find(cell);
    for (const auto& [status, reason] : what.failures) {
      if (what.source == Source::ours)
        out.push_back("ours must not fail: " + line_of(cell, status, reason));
      else if (peers && (listed == known.end() || !listed->second.contains(status)))
        out.push_back("new failure: " + line_of(cell, status, reason));
    }
    if (peers && listed != known.end() && what.tried && what.failures.empty() &&
        !listed->second.contains("ok"))
      out.push_back("no longer fails: " + line_of(cell, "ok", "remove this line"));
  }
  for (const auto& [cell, statuses] : known)
    if (tasks.contains(cell.task) && !found.contains(cell))
      out.push_back("no such method or case: " + line_of(cell, *statuses.begin(), "remove this line"));
  return out;
}

}  // namespace treeline::bench
