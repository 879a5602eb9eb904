// OBJ and OFF: text. Both are checked line by line and rewritten in their plainest form (positions and faces
// only), so that OpenMesh meets no comment, material file, relative index or normal that it would misread.
#include <unordered_set>

#include "datasets_gen/files/input.hpp"

namespace treeline::datasets::files {
namespace {

/// One position from three words; appends it to the text.
void take_position(const Input& in, std::size_t line, const std::vector<std::string_view>& words,
                   std::size_t first, Checked& r) {
  if (words.size() < first + 3) in.fail_line(line, "a vertex needs three coordinates");
  geometry::Vec3d& point = r.doubles.emplace_back();
  for (std::size_t k = first; k < first + 3; ++k) {
    const auto value = number<double>(words[k]);
    if (!value || !std::isfinite(*value)) in.fail_line(line, in_quotes(words[k]) + " is not a finite number");
    if (!r.coordinates.add(static_cast<int>(k - first), *value, number<float>(words[k]).value_or(0)))
      in.fail_line(line, in_quotes(words[k]) + " is beyond the range of float");
    point[static_cast<int>(k - first)] = *value;
    r.text += (k > first ? " " : "");
    r.text += words[k];
  }
  r.text += '\n';
  ++r.vertices;
}

using Polygon = std::vector<std::uint64_t>;  // vertices, counted from 1

std::size_t different(Polygon corners) {
  std::ranges::sort(corners);
  return static_cast<std::size_t>(std::unique(corners.begin(), corners.end()) - corners.begin());
}
/// Leaves each corner out that is named twice in a row.
void take_once(Polygon& corners) {
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
}

/// The statements of faces, in their order. Those that name a vertex again wait until it is known how many
/// vertices there are.
class Faces {
 public:
  void add(const Polygon& corners) {
    if (different(corners) < corners.size())
      waiting_.push_back({text_.size(), corners});
    else
      append(text_, corners);
  }
  /// After vertices of the text, and those that stand in for some of them.
  std::string text(std::uint64_t vertices, std::vector<std::uint32_t>& stand_ins) const {
    std::string r;
    std::size_t done = 0;
    std::unordered_set<std::uint64_t> named;
    for (auto [at, corners] : waiting_) {
      r.append(text_, done, at - done), done = at;
      named.clear();
      for (std::uint64_t& c : corners) {
        if (named.insert(c).second) continue;
        stand_ins.push_back(static_cast<std::uint32_t>(c - 1));
        c = vertices + stand_ins.size();
      }
      append(r, corners);
    }
    return r.append(text_, done, std::string::npos);
  }

 private:
  struct Waiting {
    std::size_t at;  // in the text of the others
    Polygon corners;
  };
  static void append(std::string& to, const Polygon& corners) {
    to += 'f';
    for (const std::uint64_t c : corners) to += ' ' + std::to_string(c);
    to += '\n';
  }

  std::string text_;
  std::vector<Waiting> waiting_;
};

}  // namespace

Checked check_obj(const Input& in) {
  Checked r;
  Lines lines(in.bytes);
  std::string_view line;
  std::string joined;
  std::vector<std::string_view> w;
  /// Geometry that OBJ has and that is not read, by its statements.
  struct Skipped {
    std::string_view word, what;
    std::size_t count = 0;
  };
  std::array<Skipped, 5> skipped{{{"p", "points"},
                                  {"l", "lines"},
                                  {"curv", "curves"},
                                  {"curv2", "curves on surfaces"},
                                  {"surf", "free-form surfaces"}}};
  Faces faces;
  Polygon corners;
  std::uint64_t largest = 0;
  std::size_t largest_line = 0, repeating = 0, repeating_line = 0;
  while (lines.next(line)) {
    const std::size_t at = lines.number();
    if (line.ends_with('\\')) {  // goes on in the next line
      joined.clear();
      do {
        joined.append(line.substr(0, line.size() - 1)) += ' ';
        if (!lines.next(line)) in.fail_line(at, "the file ends within a continued line");
      } while (line.ends_with('\\'));
      line = joined.append(line);
    }
    if (line.find('\0') != std::string_view::npos) in.fail_line(at, "not text: a zero byte");
    split(line.substr(0, line.find('#')), blanks, w);
    if (w.empty()) continue;
    if (w[0] == "v") {
      r.text += "v ";
      take_position(in, at, w, 1, r);
    } else if (w[0] == "f") {
      if (w.size() < 4) in.fail_line(at, "a face of " + std::to_string(w.size() - 1) + " corners");
      corners.clear();
      for (std::size_t k = 1; k < w.size(); ++k) {
        const auto index = number<std::int64_t>(w[k].substr(0, w[k].find('/')));
        if (!index) in.fail_line(at, in_quotes(w[k]) + " is not a vertex index");
        const std::int64_t from_one =
            *index < 0 ? static_cast<std::int64_t>(r.vertices) + *index + 1 : *index;
        if (from_one < 1) in.fail_line(at, "names vertex " + std::to_string(*index) + ", which is not there");
        corners.push_back(static_cast<std::uint64_t>(from_one));
        if (corners.back() > largest) largest = corners.back(), largest_line = at;
      }
      if (different(corners) < 3) {
        ++r.dropped;
        continue;
      }
      const std::size_t named = corners.size();
      take_once(corners);
      if (corners.size() < named && repeating++ == 0) repeating_line = at;
      faces.add(corners);
      ++r.polygons;
    } else if (line.size() > 4096 || static_cast<unsigned char>(w[0][0]) < 32 ||
               static_cast<unsigned char>(w[0][0]) > 126) {
      in.fail_line(at, "not a line of an OBJ file: " + in_quotes(w[0]));
    } else if (const auto s = std::ranges::find(skipped, w[0], &Skipped::word); s != skipped.end()) {
      ++s->count;
    }  // any other statement is no geometry: texture, normals, groups, materials
  }
  for (const Skipped& s : skipped)
    if (s.count > 0)
      r.notes.push_back("left out " + std::to_string(s.count) + " statements '" + std::string(s.word) +
                        "' (" + std::string(s.what) + "): only vertices and faces are read");
  if (repeating > 0)
    r.notes.push_back("polygons that name a vertex twice in a row: " + std::to_string(repeating) +
                      ", the first in line " + std::to_string(repeating_line) + "; it was taken once");
  if (largest > r.vertices)
    in.fail_line(largest_line, "names vertex " + std::to_string(largest) + " of " +
                                   std::to_string(r.vertices) + " (counted from 1)");
  if (r.vertices == 0) in.fail("", "holds no vertex (no line that starts with 'v')");
  r.is_mesh = r.polygons + r.dropped > 0;
  const std::string statements = faces.text(r.vertices, r.stand_ins);
  for (std::size_t i = 0; i < r.stand_ins.size(); ++i) r.text += "v 0 0 0\n";
  r.text += statements;
  return r;
}

Checked check_off(const Input& in) {
  Lines lines(in.bytes);
  std::string_view line;
  std::vector<std::string_view> w;
  const auto next = [&](const std::string& wanted) {
    do {
      if (!lines.next(line)) in.fail_line(lines.number(), "the file ends here; still to come: " + wanted);
      split(line.substr(0, line.find('#')), blanks, w);
    } while (w.empty());
  };
  next("the word OFF");
  static constexpr std::string_view plain[] = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                               "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
  if (std::ranges::find(plain, w[0]) == std::end(plain))
    in.fail_line(lines.number(), "an OFF file starts with 'OFF'; this is " + in_quotes(w[0]));
  if (w.size() > 1 && w[1] == "BINARY")
    in.fail_line(lines.number(), "binary OFF is not read; save it as text");
  if (w.size() > 1)
    w.erase(w.begin());  // counts on the first line
  else
    next("the counts");
  std::size_t counts[2];
  for (std::size_t k = 0; k < 2; ++k) {
    const auto n = w.size() > k ? number<std::uint64_t>(w[k]) : std::nullopt;
    if (!n) in.fail_line(lines.number(), "expected the counts of vertices, faces and edges");
    // A vertex takes at least 6 bytes of text, a face 8.
    if (*n > in.bytes.size() / 6)
      in.fail_line(lines.number(), "promises " + std::to_string(*n) + (k == 0 ? " vertices" : " faces") +
                                       ", more than the file has room for");
    counts[k] = static_cast<std::size_t>(*n);
  }
  Checked r;
  r.text = "OFF\n" + std::to_string(counts[0]) + " " + std::to_string(counts[1]) + " 0\n";
  for (std::size_t i = 0; i < counts[0]; ++i) {
    next("vertex " + std::to_string(i) + " of " + std::to_string(counts[0]));
    take_position(in, lines.number(), w, 0, r);
  }
  for (std::size_t i = 0; i < counts[1]; ++i) {
    next("face " + std::to_string(i) + " of " + std::to_string(counts[1]));
    const auto n = number<std::uint64_t>(w[0]);
    if (!n || *n < 3 || *n > w.size() - 1)
      in.fail_line(lines.number(),
                   "face " + std::to_string(i) + ": expected a count of at least 3 and as many indices");
    r.text += w[0];
    for (std::size_t k = 1; k <= *n; ++k) {
      const auto index = number<std::int64_t>(w[k]);
      if (!index || *index < 0 || static_cast<std::uint64_t>(*index) >= counts[0])
        in.fail_line(lines.number(), "face " + std::to_string(i) + " names vertex " + in_quotes(w[k]) +
                                         " of " + std::to_string(counts[0]) + " (counted from 0)");
      (r.text += ' ') += w[k];
    }
    r.text += '\n';
    ++r.polygons;
  }
  while (lines.next(line))
    if (split(line.substr(0, line.find('#')), blanks, w), !w.empty())
      in.fail_line(lines.number(), "values follow the last face that the counts promise");
  if (r.vertices == 0) in.fail("", "holds no vertex");
  r.is_mesh = r.polygons > 0;
  return r;
}

}  // namespace treeline::datasets::files
