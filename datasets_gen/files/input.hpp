// A file in memory, and the small tools with which the readers look at it. Internal to the readers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets_gen/files/read.hpp"

namespace treeline::datasets::files {

/// The whole file, and how to complain about it.
struct Input {
  std::filesystem::path path;
  std::string bytes;    // without the mark below
  bool marked = false;  // begins with UTF-8's byte order mark, as some editors and spreadsheets write it

  [[noreturn]] void fail(std::string place, std::string problem) const {
    throw FileError(path, std::move(place), std::move(problem));
  }
  [[noreturn]] void fail_line(std::size_t line, std::string problem) const {
    fail("line " + std::to_string(line), std::move(problem));
  }
};

/// What a reader returns, before rounding to float.
struct Raw {
  std::vector<geometry::Vec3d> points;
  std::vector<std::array<std::uint32_t, 3>> faces;
  bool is_mesh = false;
  double rounded = 0;  // the farthest that the reader itself moved a coordinate to make a float of it
  std::vector<std::string> notes;
};

// ---- text ----------------------------------------------------------------------------------------------

/// Lines with their numbers; "\r\n" and "\n" both end one.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return true;
  }
  std::size_t number() const { return number_; }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Splits at any of the separators into `words`, leaving out empty ones.
inline void split(std::string_view line, std::string_view separators, std::vector<std::string_view>& words) {
  words.clear();
  for (std::size_t at = line.find_first_not_of(separators); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(separators, end);
  }
}
inline constexpr std::string_view blanks = " \t\v\f";

/// The number that a whole word spells, or nothing. "nan" and "inf" are numbers to from_chars.
template <class T>
std::optional<T> number(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range && end == word.data() + word.size()) {
    // Too small for T reads as zero; too large is for the caller to refuse.
    if constexpr (std::is_floating_point_v<T>) {
      const std::size_t e = word.find_first_of("eE");
      return e != std::string_view::npos && word.substr(e + 1).starts_with('-')
                 ? T(0)
                 : std::numeric_limits<T>::max();
    }
    return std::nullopt;
  }
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Whether float has no finite number for x.
inline bool beyond_float(double x) {
  return std::isfinite(x) && std::abs(x) > static_cast<double>(std::numeric_limits<float>::max());
}

/// A word for an error message: short, and printable.
inline std::string in_quotes(std::string_view word) {
  std::string r = "'";
  for (const char c : word.substr(0, 40)) r += c >= 32 && c < 127 ? c : '?';
  return r + (word.size() > 40 ? "…'" : "'");
}

// ---- what a file must hold, found by the checks ---------------------------------------------------------

/// The coordinates as the check read them: their bits summed, to compare with what the library then read, and
/// how far float is from the double in the file.
struct Coordinates {
  std::uint64_t bits = 0;
  double largest_error = 0;
  geometry::Box3d box;  // of the finite ones

  static std::uint64_t bits_of(float x) {
    return std::isfinite(x) ? std::bit_cast<std::uint32_t>(x) : 0x7fc00000u;
  }
  /// False if x is finite and float cannot hold it.
  bool add(int axis, double x, float rounded) {
    bits += bits_of(rounded);
    if (!std::isfinite(x)) return true;
    if (beyond_float(x)) return false;
    largest_error = std::max(largest_error, std::abs(x - static_cast<double>(rounded)));
    box.low[axis] = std::min(box.low[axis], x), box.high[axis] = std::max(box.high[axis], x);
    return true;
  }
};

struct Checked {
  std::size_t vertices = 0, polygons = 0;
  std::size_t dropped = 0;  // polygons that OpenMesh leaves out, because their corners coincide
  /// Vertices that follow the file's own in `text`, each to stand for one of these in a polygon that names it
  /// again: OpenMesh's OBJ reader leaves out what is named twice, and with it the way back from a hole.
  std::vector<std::uint32_t> stand_ins;
  bool is_mesh = true;
  bool compare_bits = true;  // false where the library merges equal vertices
  bool binary = false;
  Coordinates coordinates;
  std::vector<geometry::Vec3d> doubles;  // the vertices, where the file has doubles and the library floats
  std::vector<std::string> notes;        // of what the file holds and is not read
  std::string text;  // the file rewritten in the plainest form of its format; empty: take the file as it is
};

Checked check_ply(const Input&);
Checked check_obj(const Input&);
Checked check_off(const Input&);
Checked check_stl(const Input&);

// ---- the readers ---------------------------------------------------------------------------------------

/// By OpenMesh, after the check of its format. `format` is "ply", "obj", "off" or "stl".
Raw read_openmesh(const Input&, const std::string& format, const Checked&);
Raw read_assimp(const Input&);
Raw read_pcd(const Input&);
Raw read_xyz(const Input&);

}  // namespace treeline::datasets::files
