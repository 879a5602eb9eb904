// For command lines: whole numbers of 64 bits, seeds above all, that are taken as they are or refused.
//
// CLI11 by itself wraps -1 to the largest number there is. Not by way of double, which cannot tell 2^64 - 1
// from 2^64.
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <string>

namespace treeline::datasets {

/// For check() of an option that is a std::uint64_t.
inline CLI::Validator whole_number() {
  return CLI::Validator(
      [](const std::string& text) {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool good = error == std::errc() && end == text.data() + text.size();
        return good ? std::string() : "'" + text + "' is not a whole number from 0 to 2^64 - 1";
      },
      "");
}

}  // namespace treeline::datasets
