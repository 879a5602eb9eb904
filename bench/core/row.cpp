#include "bench/core/row.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "bench/core/environment.hpp"

namespace treeline::bench {
namespace {

using Json = nlohmann::ordered_json;

template <class Enum, std::size_t N>
Enum word_from(std::string_view word, const std::array<std::string_view, N>& words, const char* what) {
  for (std::size_t i = 0; i < N; ++i)
    if (words[i] == word) return static_cast<Enum>(i);
  throw std::invalid_argument("unknown " + std::string(what) + " '" + std::string(word) + "'");
}

constexpr std::array<std::string_view, 4> claims{"exact", "bounded", "approximate", "stochastic"};
constexpr std::array<std::string_view, 2> sources{"ours", "peer"};
constexpr std::array<std::string_view, 8> statuses{"ok",      "wrong",         "refused",     "crashed",
                                                   "timeout", "out_of_memory", "unsupported", "not_built"};

Json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}
Json text(const std::string& value) { return value.empty() ? Json(nullptr) : Json(value); }

std::optional<double> number_from(const Json& row, const char* field) {
  const Json& value = row.at(field);
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}
std::string text_from(const Json& row, const char* field) {
  const Json& value = row.at(field);
  return value.is_null() ? std::string() : value.get<std::string>();
}

std::string hex16(std::uint64_t value) {
  std::string out(16, '0');
  for (int i = 15; i >= 0; --i, value >>= 4) out[i] = "0123456789abcdef"[value & 15];
  return out;
}

std::string join_key(const Json& row) {
  Json key = Json::array();
  for (const char* field : {"task", "block", "dataset_hash", "seed", "method", "build_knobs", "query_knobs",
                            "query_set", "queries", "threads"})
    key.push_back(row.at(field));
  return key.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json fields(const Row& r) {
  Json samples = Json::array();
  for (double sample : r.samples) samples.push_back(number(sample));
  const Errors& e = r.errors;
  Json row{{"schema", Row::schema},
           {"task", r.task},
           {"block", r.block},
           {"dataset", r.dataset},
           {"n", r.n},
           {"seed", r.seed},
           {"dataset_hash", text(r.dataset_hash)},
           {"method", r.method},
           {"family", text(r.family)},
           {"source", to_string(r.source)},
           {"peer_version", text(r.peer_version)},
           {"claim", to_string(r.claim)},
           {"build_knobs", r.build_knobs},
           {"query_knobs", r.query_knobs},
           {"query_set", text(r.query_set)},
           {"advised", r.advised},
           {"queries", r.queries},
           {"threads", r.threads},
           {"status", to_string(r.status)},
           {"reason", text(r.reason)},
           {"build_s", number(r.build_s)},
           {"query_ns", number(r.query_ns)},
           {"query_ns_low", number(r.query_ns_low)},
           {"query_ns_high", number(r.query_ns_high)},
           {"query_cpu_ns", number(r.query_cpu_ns)},
           {"samples", r.samples.empty() ? Json(nullptr) : samples},
           {"bytes", r.bytes ? Json(*r.bytes) : Json(nullptr)},
           {"input_bytes", r.input_bytes ? Json(*r.input_bytes) : Json(nullptr)},
           {"error", number(e.error)},
           {"error_max", number(e.max)},
           {"error_p99", number(e.p99)},
           {"error_mean", number(e.mean)},
           {"bias", number(e.bias)},
           {"error_floor", number(e.floor)},
           {"work_nodes", number(r.work_nodes)},
           {"work_primitives", number(r.work_primitives)}};
  for (const auto& [field, value] : e.extra.items())
    row[field] = value.is_number_float() && !std::isfinite(value.get<double>()) ? Json(nullptr) : value;
  return row;
}

}  // namespace

std::string_view to_string(Claim c) { return claims[static_cast<std::size_t>(c)]; }
std::string_view to_string(Source s) { return sources[static_cast<std::size_t>(s)]; }
std::string_view to_string(Status s) { return statuses[static_cast<std::size_t>(s)]; }
Status status_from(std::string_view word) { return word_from<Status>(word, statuses, "status"); }

std::string Row::key() const { return join_key(fields(*this)); }

Json Row::to_json() const {
  Json row = fields(*this);
  row.update(environment());
  row["time"] = utc_now();
  return row;
}

std::string Row::to_line() const { return to_json().dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string format_hash(std::uint64_t hash) { return hex16(hash); }

Row Row::from_json(const Json& row) {
  if (row.at("schema") != schema)
    throw std::invalid_argument("row of schema " + row.at("schema").dump() + ", expected " +
                                std::to_string(schema));
  Row r;
  r.task = text_from(row, "task"), r.block = text_from(row, "block"), r.dataset = text_from(row, "dataset");
  r.n = row.at("n"), r.seed = row.at("seed"), r.dataset_hash = text_from(row, "dataset_hash");
  r.method = text_from(row, "method"), r.family = text_from(row, "family");
  r.source = word_from<Source>(text_from(row, "source"), sources, "source");
  r.peer_version = text_from(row, "peer_version");
  r.claim = word_from<Claim>(text_from(row, "claim"), claims, "claim");
  r.build_knobs = row.at("build_knobs"), r.query_knobs = row.at("query_knobs");
  r.query_set = text_from(row, "query_set");
  r.advised = row.value("advised", false);  // older rows do not say
  r.queries = row.at("queries"), r.threads = row.at("threads");
  r.status = status_from(text_from(row, "status")), r.reason = text_from(row, "reason");
  r.build_s = number_from(row, "build_s");
  r.query_ns = number_from(row, "query_ns");
  r.query_ns_low = number_from(row, "query_ns_low"), r.query_ns_high = number_from(row, "query_ns_high");
  r.query_cpu_ns = number_from(row, "query_cpu_ns");
  if (!row.at("samples").is_null()) r.samples = row.at("samples").get<std::vector<double>>();
  if (!row.at("bytes").is_null()) r.bytes = row.at("bytes").get<std::size_t>();
  if (const auto kept = row.find("input_bytes");
      kept != row.end() && !kept->is_null())  // older rows have none
    r.input_bytes = kept->get<std::size_t>();
  Errors& e = r.errors;
  e.error = number_from(row, "error"), e.max = number_from(row, "error_max");
  e.p99 = number_from(row, "error_p99"), e.mean = number_from(row, "error_mean");
  e.bias = number_from(row, "bias"), e.floor = number_from(row, "error_floor");
  e.within_claim = r.status != Status::wrong;
  for (const auto& [field, value] : row.items())
    if (field.starts_with(r.task + "_")) e.extra[field] = value;
  r.work_nodes = number_from(row, "work_nodes"), r.work_primitives = number_from(row, "work_primitives");
  return r;
}

}  // namespace treeline::bench
