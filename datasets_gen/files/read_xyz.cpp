// Points as lines of text: x, y and z first, whatever else after them. Comments start with # or //. The first
// line may name the columns; then x, y and z are taken from the columns of those names, in either case.
#include <algorithm>
#include <cctype>
#include <utility>

#include "datasets_gen/files/input.hpp"

namespace treeline::datasets::files {
namespace {

std::string lower(std::string_view word) {
  std::string r(word);
  for (char& c : r) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  r.erase(std::remove(r.begin(), r.end(), '"'), r.end());
  return r;
}

}  // namespace

Raw read_xyz(const Input& in) {
  constexpr std::string_view separators = " \t\v\f,;";
  Raw r;
  std::array<std::size_t, 3> column{0, 1, 2};
  std::size_t widest = 3;
  Lines lines(in.bytes);
  std::string_view line;
  std::vector<std::string_view> w;
  bool first = true;
  while (lines.next(line)) {
    const std::size_t at = lines.number();
    split(line.substr(0, std::min(line.find('#'), line.find("//"))), separators, w);
    if (w.empty()) continue;
    if (std::exchange(first, false) && !number<double>(w[0])) {  // a header
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto it = std::ranges::find_if(
            w, [&](auto word) { return lower(word) == std::string(1, char('x' + axis)); });
        if (it == w.end())
          in.fail_line(at, "neither a point nor a header with the columns x, y and z: " + in_quotes(line));
        column[axis] = static_cast<std::size_t>(it - w.begin());
      }
      widest = std::ranges::max(column) + 1;
      continue;
    }
    if (w.size() < widest)
      in.fail_line(
          at, "a point needs " + std::to_string(widest) + " values; here are " + std::to_string(w.size()));
    geometry::Vec3d p;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = w[column[static_cast<std::size_t>(axis)]];
      const auto value = number<double>(word);
      if (!value) in.fail_line(at, in_quotes(word) + " is not a number");
      p[axis] = *value;
    }
    r.points.push_back(p);
  }
  if (r.points.empty()) in.fail("", "holds no points");
  return r;
}

}  // namespace treeline::datasets::files
