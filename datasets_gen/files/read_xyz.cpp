// Points as lines of text: x, y and z first, whatever else after them. Comments start with # or //. The first
// line may name the columns; then x, y and z are taken from the columns of those names, in either case.
//
// The first line decides what separates the fields of the whole file: semicolons if it has any, else commas,
// else blanks. Between semicolons or commas a field may be empty, so that a missing value never moves the
// next one into its place; and every line has as many fields as the first. A file without names whose first
// column counts its points is refused: that column is an id far more often than it is x.
#include <algorithm>
#include <cctype>
#include <utility>

#include "datasets_gen/files/input.hpp"

namespace treeline::datasets::files {
namespace {

/// Without blanks around it, nor a pair of quotes around the rest.
std::string_view bare(std::string_view word) {
  const auto trim = [&] {
    word.remove_prefix(std::min(word.find_first_not_of(blanks), word.size()));
    word.remove_suffix(word.size() - (word.find_last_not_of(blanks) + 1));
  };
  trim();
  if (word.size() > 1 && word.front() == '"' && word.back() == '"') {
    word = word.substr(1, word.size() - 2);
    trim();
  }
  return word;
}

/// Splits at each separator outside of quotes, keeping empty fields.
void split_at(std::string_view line, char separator, std::vector<std::string_view>& words) {
  words.clear();
  bool quoted = false;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != separator)) continue;
    words.push_back(bare(line.substr(start, i - start)));
    start = i + 1;
  }
}

bool is_axis(std::string_view word, std::size_t axis) {
  return word.size() == 1 && std::tolower(static_cast<unsigned char>(word[0])) == char('x' + axis);
}

/// Whether a first column counts the lines: 0, 1, 2, … or 1, 2, 3, …, as numbers without a fraction.
class Counter {
 public:
  void add(std::string_view word) {
    const auto value = number<std::uint64_t>(word);
    if (count_ == 0 && value) first_ = *value;
    counts_ = counts_ && value && first_ <= 1 && *value == first_ + count_;
    ++count_;
  }
  bool counts() const { return counts_ && count_ >= least; }
  std::uint64_t first() const { return first_; }

 private:
  static constexpr std::uint64_t least = 3;  // of fewer it may be chance
  bool counts_ = true;
  std::uint64_t first_ = 0, count_ = 0;
};

bool has_decimal_comma(std::string_view word) {
  std::string pointed(word);
  std::ranges::replace(pointed, ',', '.');
  return word.find(',') != std::string_view::npos && number<double>(pointed);
}

}  // namespace

Raw read_xyz(const Input& in) {
  Raw r;
  std::array<std::size_t, 3> column{0, 1, 2};
  std::size_t width = 0;  // fields of each line
  char separator = ' ';
  bool named = false;
  Counter ids;
  Lines lines(in.bytes);
  std::string_view line;
  std::vector<std::string_view> w;
  while (lines.next(line)) {
    const std::size_t at = lines.number();
    const std::string_view text = line.substr(0, std::min(line.find('#'), line.find("//")));
    if (text.find_first_not_of(blanks) == std::string_view::npos) continue;
    const bool first = width == 0;
    if (first)
      for (const char s : {',', ';'})
        if (text.find(s) != std::string_view::npos) separator = s;
    if (separator == ' ') {
      split(text, blanks, w);
      for (auto& word : w) word = bare(word);
    } else {
      split_at(text, separator, w);
    }
    if (first) {
      width = w.size();
      if (!number<double>(w[0])) {  // a header, or wrong
        std::size_t axes = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto named_so = [&](auto word) { return is_axis(word, axis); };
          const auto it = std::ranges::find_if(w, named_so);
          if (it == w.end()) continue;
          column[axis] = static_cast<std::size_t>(it - w.begin()), ++axes;
          if (const auto second = std::find_if(it + 1, w.end(), named_so); second != w.end())
            in.fail_line(at, std::string("two columns are called ") + char('x' + axis) + ", fields " +
                                 std::to_string(it - w.begin() + 1) + " and " +
                                 std::to_string(second - w.begin() + 1));
        }
        named = axes == 3;
        if (named) continue;
        if (!has_decimal_comma(w[0]) && !w[0].empty())
          in.fail_line(at, "neither a point nor a header with the columns x, y and z: " + in_quotes(line));
        column = {0, 1, 2};
      }
      if (width < 3) in.fail_line(at, "a point needs 3 values; here are " + std::to_string(width));
    }
    if (w.size() != width)
      in.fail_line(
          at, "has " + std::to_string(w.size()) + " fields; the first line has " + std::to_string(width));
    geometry::Vec3d p;
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t c = column[static_cast<std::size_t>(axis)];
      const auto value = number<double>(w[c]);
      const auto fail = [&](const std::string& problem) {
        in.fail_line(at, "field " + std::to_string(c + 1) + ", " + char('x' + axis) + ": " + problem);
      };
      if (w[c].empty()) fail("is empty");
      if (has_decimal_comma(w[c]))
        fail(in_quotes(w[c]) + " has a decimal comma; only decimal points are read");
      if (!value)
        fail(in_quotes(w[c]) + " is not a number" +
             (separator == ',' && w[c].find_first_of(blanks) != std::string_view::npos
                  ? "; commas separate the fields of this file, and decimal commas are not read"
                  : ""));
      if (beyond_float(*value)) fail(in_quotes(w[c]) + " is beyond the range of float");
      p[axis] = *value;
    }
    if (!named && width > 3) ids.add(w[0]);
    r.points.push_back(p);
  }
  if (r.points.empty()) in.fail("", "holds no points");
  if (!named && ids.counts()) {
    const std::string separated = separator == ' ' ? " " : std::string(1, separator);
    std::string names = "id" + separated + "x" + separated + "y" + separated + "z";
    for (std::size_t c = 4; c < width; ++c) names += separated + "c" + std::to_string(c + 1);
    in.fail(
        "",
        "the first of its " + std::to_string(width) + " columns counts the points from " +
            std::to_string(ids.first()) +
            " on, as an id does, and no line names the columns. Put a first line before it that does, e.g. " +
            in_quotes(names) + "; if that column is x, name it x");
  }
  return r;
}

}  // namespace treeline::datasets::files
