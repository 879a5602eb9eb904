// Rows: one measured cell as a flat record, written as one JSON object a line. Null is never left out, NaN
// never written.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace treeline::bench {

/// A flat object: knob name → number, string or bool. Ordered, so that equal knobs print alike.
using Knobs = nlohmann::ordered_json;

enum class Claim { exact, bounded, approximate, stochastic };
enum class Source { ours, peer };
enum class Status { ok, wrong, refused, crashed, timeout, out_of_memory, unsupported, not_built };

std::string_view to_string(Claim);
std::string_view to_string(Source);
std::string_view to_string(Status);
/// Throws std::invalid_argument for a word that is none.
Status status_from(std::string_view);

/// How far the answers of one cell are from the truth. What does not apply stays empty.
struct Errors {
  std::optional<double> error, max, p99, mean, bias, floor;
  bool within_claim = true;       ///< false: the row's status becomes `wrong`
  std::string reason;             ///< why not within the claim, with the first offending query
  Knobs extra = Knobs::object();  ///< the task's own fields, prefixed by its name
};

struct Row {
  static constexpr int schema = 1;
  std::string task, block, dataset;
  std::size_t n = 0;
  std::uint64_t seed = 0;
  std::string dataset_hash;  // 16 hex digits
  std::string method, family;
  Source source = Source::ours;
  std::string peer_version;  // empty: null
  Claim claim = Claim::exact;
  Knobs build_knobs = Knobs::object(), query_knobs = Knobs::object();
  std::string query_set;
  bool advised =
      false;  // one of the sets on which --advise measures (Task::advise_on), and the report with it
  std::size_t queries = 0;
  int threads = 1;
  Status status = Status::ok;
  std::string reason;
  std::optional<double> build_s, query_ns, query_ns_low, query_ns_high, query_cpu_ns;
  std::vector<double> samples;             // ns per query, one a repetition
  std::optional<std::size_t> bytes;        // that the build left allocated
  std::optional<std::size_t> input_bytes;  // of the caller's data that must stay beside them; 0 with a copy
  Errors errors;
  std::optional<double> work_nodes, work_primitives;  // per query

  /// Two rows of one key measure the same cell.
  std::string key() const;
  /// Adds isa, flags, compiler, cpu, host, commit and time.
  nlohmann::ordered_json to_json() const;
  /// to_json() on one line, without the line's end; text that is not UTF-8 is repaired.
  std::string to_line() const;
  /// Reads a row back, leaving out what to_json() adds. Throws (nlohmann or std) for what is not a row.
  static Row from_json(const nlohmann::ordered_json&);
};

/// 16 hex digits, as in Row::dataset_hash.
std::string format_hash(std::uint64_t);

}  // namespace treeline::bench
