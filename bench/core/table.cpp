#include "bench/core/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "bench/core/cells.hpp"

namespace treeline::bench {
namespace {

constexpr std::size_t reason_width = 60;

std::string shortened(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  if (text.size() <= reason_width) return text;
  std::size_t end = reason_width - 3;
  if (const std::size_t word = text.find_last_of(' ', end);
      word != std::string::npos && word > reason_width / 2)
    end = word;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // whole UTF-8 characters
  return text.substr(0, end) + "…";
}

std::string knobs_of(const Row& row) {
  const std::string build = format_knobs(row.build_knobs), query = format_knobs(row.query_knobs);
  if (query == "-") return build;
  return build == "-" ? query : build + " " + query;
}

struct Unit {
  double ns;
  const char* name;
};
Unit unit_of(double ns) {
  if (ns < 1e3) return {1, "ns"};
  if (ns < 1e6) return {1e3, "µs"};
  return ns < 1e9 ? Unit{1e6, "ms"} : Unit{1e9, "s"};
}

}  // namespace

std::string format_time_ns(double ns) {
  const Unit unit = unit_of(ns);
  return fmt::format("{:.3g} {}", ns / unit.ns, unit.name);
}

std::string format_time(const Row& row) {
  if (!row.query_ns) return "-";
  if (!row.query_ns_low || !row.query_ns_high || row.samples.size() < 2) return format_time_ns(*row.query_ns);
  const Unit unit = unit_of(*row.query_ns);
  return fmt::format("{:.3g} {} [{:.3g}, {:.3g}]", *row.query_ns / unit.ns, unit.name,
                     *row.query_ns_low / unit.ns, *row.query_ns_high / unit.ns);
}

std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", n, n == 1 ? one : many.empty() ? one + "s" : many);
}

std::string format_error(std::optional<double> error) { return error ? fmt::format("{:.2g}", *error) : "-"; }

std::string format_bytes(std::size_t bytes) {
  const auto b = static_cast<double>(bytes);
  if (b < 1024) return fmt::format("{} B", bytes);
  if (b < 1048576) return fmt::format("{:.1f} KiB", b / 1024);
  if (b < 1073741824) return fmt::format("{:.1f} MiB", b / 1048576);
  return fmt::format("{:.2f} GiB", b / 1073741824);
}

std::string format_table(const std::vector<Row>& rows) {
  if (rows.empty()) return "";
  std::vector<const Row*> sorted;
  for (const Row& row : rows) sorted.push_back(&row);
  const auto set_order = [&](const Row* row) {
    return std::find_if(rows.begin(), rows.end(),
                        [&](const Row& r) { return r.query_set == row->query_set; });
  };
  std::stable_sort(sorted.begin(), sorted.end(), [&](const Row* a, const Row* b) {
    if (a->query_set != b->query_set) return set_order(a) < set_order(b);
    constexpr double last = std::numeric_limits<double>::infinity();
    return a->query_ns.value_or(last) < b->query_ns.value_or(last);
  });
  const auto most = std::max_element(rows.begin(), rows.end(),
                                     [](const Row& a, const Row& b) { return a.queries < b.queries; });
  std::string out = fmt::format("\n{} (n = {}, a set has at most {})\n", rows.front().block, rows.front().n,
                                counted(most->queries, "query", "queries"));
  std::size_t width = 0;
  for (const Row* row : sorted) width = std::max(width, row->method.size() + 2 + knobs_of(*row).size());
  std::string set;
  for (const Row* row : sorted) {
    if (row->query_set != set || row == sorted.front()) {
      set = row->query_set;
      out += fmt::format("  {:<{}} {:<24} {:>9}  status\n", set, width + 2, "time/query [interval]", "error");
    }
    const std::string name = row->method + "  " + knobs_of(*row);
    out += fmt::format("    {:<{}} {:<24} {:>9}  {}{}\n", name, width, format_time(*row),
                       format_error(row->errors.error), to_string(row->status),
                       row->reason.empty() ? "" : ": " + shortened(row->reason));
  }
  return out;
}

}  // namespace treeline::bench
