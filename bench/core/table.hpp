// Rows for people: one table a block, the fastest first within each query set.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/core/row.hpp"

namespace treeline::bench {

std::string format_time_ns(double ns);    // "1.25 µs"
std::string format_time(const Row& row);  // "1.25 µs [1.2, 1.31]"; "-" without a time

/// "1 point", "2 points"; with `many` where that is not an s more.
std::string counted(std::size_t n, const std::string& one, const std::string& many = "");

std::string format_error(std::optional<double> error);  // "0", "1.2e-07", "-"
std::string format_bytes(std::size_t bytes);            // "1.2 MiB"
std::string format_table(const std::vector<Row>& rows);

}  // namespace treeline::bench
