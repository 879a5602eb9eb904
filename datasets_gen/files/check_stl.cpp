// STL: triangles with corners of their own, as text ("solid …") or binary (80 bytes, a count, 50 bytes a
// triangle). OpenMesh merges equal corners and leaves out triangles whose corners coincide: those are counted
// here. It merges by order of coordinates, which NaN has none of, so coordinates that are not finite are
// refused. Text is rewritten as binary, which is all that OpenMesh gets to see.
#include <bit>
#include <cstring>

#include "datasets_gen/files/input.hpp"

namespace treeline::datasets::files {
namespace {

using Corners = std::array<geometry::Vec3f, 3>;

/// Words of text STL are written in either case.
bool same_word(std::string_view lower, std::string_view word) {
  return std::ranges::equal(lower, word,
                            [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b); });
}

void count(const Corners& c, Checked& r) {
  ++(c[0] == c[1] || c[1] == c[2] || c[2] == c[0] ? r.dropped : r.polygons);
}

Checked check_binary(const Input& in) {
  if (in.bytes.size() < 84)
    in.fail("byte " + std::to_string(in.bytes.size()),
            "the file ends within the 84 bytes before the first triangle");
  std::uint32_t promised = 0;
  std::memcpy(&promised, in.bytes.data() + 80, 4);
  const std::uint64_t wanted = 84 + std::uint64_t{50} * promised;
  if (wanted != in.bytes.size())
    in.fail("byte 80", "promises " + std::to_string(promised) + " triangles, which take " +
                           std::to_string(wanted) + " bytes, and the file has " +
                           std::to_string(in.bytes.size()));
  Checked r;
  r.binary = true, r.compare_bits = false;
  for (std::size_t i = 0; i < promised; ++i) {
    Corners corners;
    std::memcpy(&corners, in.bytes.data() + 84 + 50 * i + 12, sizeof corners);
    for (const auto& corner : corners)
      if (!geometry::is_finite(corner))
        in.fail("triangle " + std::to_string(i) + ", byte " + std::to_string(84 + 50 * i),
                "a coordinate is not finite");
    count(corners, r);
  }
  return r;
}

Checked check_text(const Input& in) {
  Checked r;
  r.binary = true, r.compare_bits = false;
  r.text.assign(84, '\0');
  std::uint32_t triangles = 0;
  Lines lines(in.bytes);
  std::string_view line;
  std::vector<std::string_view> w;
  const auto next = [&](std::initializer_list<std::string_view> start) {
    do {
      if (!lines.next(line)) in.fail_line(lines.number(), "the file ends within a solid");
      split(line, blanks, w);
    } while (w.empty());
    return std::equal(start.begin(), start.end(), w.begin(),
                      w.begin() + std::min<std::ptrdiff_t>(std::ssize(w), std::ssize(start)), same_word);
  };
  const auto need = [&](std::initializer_list<std::string_view> start) {
    if (!next(start))
      in.fail_line(lines.number(),
                   "expected '" + std::string(*start.begin()) + "', found " + in_quotes(line));
  };
  need({"solid"});
  while (true) {
    if (!next({"facet", "normal"})) {
      if (!same_word("endsolid", w[0]))
        in.fail_line(lines.number(), "expected 'facet normal' or 'endsolid', found " + in_quotes(line));
      if (lines.rest().find_first_not_of(" \t\r\n") == std::string_view::npos) break;
      need({"solid"});
      continue;
    }
    need({"outer", "loop"});
    Corners corners;
    for (auto& corner : corners) {
      need({"vertex"});
      if (w.size() != 4) in.fail_line(lines.number(), "a vertex needs three coordinates");
      for (int k = 0; k < 3; ++k) {
        const std::string_view word = w[static_cast<std::size_t>(k) + 1];
        const auto value = number<double>(word);
        if (!value || !std::isfinite(*value))
          in.fail_line(lines.number(), in_quotes(word) + " is not a finite number");
        corner[k] = number<float>(word).value_or(0);
        if (!r.coordinates.add(k, *value, corner[k]))
          in.fail_line(lines.number(), in_quotes(word) + " is beyond the range of float");
      }
    }
    need({"endloop"});
    need({"endfacet"});
    count(corners, r);
    r.text.append(12, '\0').append(reinterpret_cast<const char*>(&corners), sizeof corners).append(2, '\0');
    ++triangles;
  }
  std::memcpy(r.text.data() + 80, &triangles, sizeof triangles);
  return r;
}

}  // namespace

Checked check_stl(const Input& in) {
  // Binary files may start with "solid", too: the size decides.
  std::uint32_t promised = 0;
  if (in.bytes.size() >= 84) std::memcpy(&promised, in.bytes.data() + 80, 4);
  const bool fits = in.bytes.size() >= 84 && in.bytes.size() == 84 + std::uint64_t{50} * promised;
  if (fits) return check_binary(in);
  // A binary file cut short may start with "Solid"; text in capitals has no zero byte, and that one does.
  const bool capitals =
      same_word("solid", std::string_view(in.bytes).substr(0, 5)) && in.bytes.find('\0') == std::string::npos;
  return in.bytes.starts_with("solid") || capitals ? check_text(in) : check_binary(in);
}

}  // namespace treeline::datasets::files
