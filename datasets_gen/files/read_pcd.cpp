// PCD (PCL's format): the header and the size of the data are checked here, PCL reads the points. It gets a
// header of our own: that of a file can make it read past its end (1.13, one without HEIGHT whose data look
// like text).
#include <cstring>
#include <map>

#include "datasets_gen/files/input.hpp"
#include "datasets_gen/files/pcl_pcd.hpp"

namespace treeline::datasets::files {
namespace {

struct Header {
  std::map<std::string_view, std::vector<std::string_view>> entries;
  std::map<std::string_view, std::size_t> lines;
  std::size_t line = 0, body = 0;
};

Header read_header(const Input& in) {
  static constexpr std::string_view known[] = {"VERSION", "FIELDS", "COLUMNS",   "SIZE",   "TYPE", "COUNT",
                                               "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
  Header h;
  Lines lines(in.bytes);
  std::string_view line;
  std::vector<std::string_view> w;
  while (lines.next(line)) {
    split(line.substr(0, line.find('#')), blanks, w);
    if (w.empty()) continue;
    if (std::ranges::find(known, w[0]) == std::end(known))
      in.fail_line(lines.number(), "not a line of a PCD header: " + in_quotes(w[0]));
    const std::string_view key = w[0] == "COLUMNS" ? "FIELDS" : w[0];
    h.lines[key] = lines.number();
    h.entries[key].assign(w.begin() + 1, w.end());
    if (key == "DATA") {
      h.line = lines.number();
      h.body = in.bytes.size() - lines.rest().size();
      return h;
    }
  }
  in.fail_line(lines.number(), "the file ends within the header, before DATA");
}

/// Says of the data what a reader of positions needs to know, and no more.
class PlainHeader {
 public:
  void add(std::string_view name, std::uint64_t size, std::uint64_t count, bool text) {
    const bool axis = name == "x" || name == "y" || name == "z";
    if (count == 0) return;
    fields_ += axis ? " " + std::string(name) : " other" + std::to_string(others_++);
    // Others are skipped: as text by their number, else by their size.
    sizes_ += ' ' + std::to_string(text && !axis ? 4 : size);
    types_ += axis || text || size == 8 ? " F" : " I";
    counts_ += ' ' + std::to_string(count);
  }
  std::string text(std::uint64_t points, std::string_view data) const {
    const std::string n = std::to_string(points);
    return "VERSION 0.7\nFIELDS" + fields_ + "\nSIZE" + sizes_ + "\nTYPE" + types_ + "\nCOUNT" + counts_ +
           "\nWIDTH " + n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " +
           std::string(data) + "\n";
  }

 private:
  std::string fields_, sizes_, types_, counts_;
  std::size_t others_ = 0;
};

/// Bytes that LZF data (Lehmann 2000) unpack to, or nothing where they are broken: a copy from before the
/// start, or instructions that go on behind the end, where PCL would read on.
std::optional<std::uint64_t> unpacked_size(std::string_view packed) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(packed[i]); };
  std::uint64_t size = 0;
  for (std::size_t at = 0; at < packed.size();) {
    const unsigned control = byte(at++);
    if (control < 32) {  // so many bytes, and one, as they are
      if (packed.size() - at < control + 1) return std::nullopt;
      at += control + 1, size += control + 1;
      continue;
    }
    unsigned length = control >> 5;
    if (packed.size() - at < (length == 7 ? 2u : 1u)) return std::nullopt;
    if (length == 7) length += byte(at++);
    const unsigned back = ((control & 31) << 8 | byte(at++)) + 1;
    if (back > size) return std::nullopt;
    size += length + 2;
  }
  return size;
}

}  // namespace

Raw read_pcd(const Input& in) {
  const Header h = read_header(in);
  const auto entry = [&](std::string_view key) -> const std::vector<std::string_view>& {
    const auto it = h.entries.find(key);
    if (it == h.entries.end() || it->second.empty()) in.fail("header", "there is no " + std::string(key));
    return it->second;
  };
  const auto natural = [&](std::string_view key, std::string_view word) {
    const auto n = number<std::uint64_t>(word);
    if (!n || *n > std::uint64_t{1} << 40) in.fail_line(h.lines.at(key), in_quotes(word) + " is not a count");
    return *n;
  };
  const auto &fields = entry("FIELDS"), &sizes = entry("SIZE"), &types = entry("TYPE");
  if (sizes.size() != fields.size() || types.size() != fields.size())
    in.fail_line(h.lines.at("SIZE"), "FIELDS, SIZE and TYPE differ in length");
  const bool counts = h.entries.contains("COUNT");
  if (counts && entry("COUNT").size() != fields.size())
    in.fail_line(h.lines.at("COUNT"), "FIELDS and COUNT differ in length");
  std::uint64_t point_bytes = 0, point_words = 0;
  std::vector<std::pair<std::size_t, bool>> axis_words;  // which of a point's, and whether it is a float
  double rounded = 0;                                    // the farthest that float moves one of text
  unsigned axes = 0;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::uint64_t size = natural("SIZE", sizes[i]),
                        count = counts ? natural("COUNT", entry("COUNT")[i]) : 1;
    if (size != 1 && size != 2 && size != 4 && size != 8)
      in.fail_line(h.lines.at("SIZE"), in_quotes(sizes[i]) + " bytes");
    if (count > in.bytes.size())
      in.fail_line(h.lines.at("COUNT"), "more values in a point than the file has bytes");
    point_bytes += size * count, point_words += count;
    if (types[i] != "F" && types[i] != "U" && types[i] != "I")
      in.fail_line(h.lines.at("TYPE"), in_quotes(types[i]) + " is no type; F, U and I are");
    if (fields[i] == "x" || fields[i] == "y" || fields[i] == "z") {
      if (types[i] != "F" || size < 4 || count != 1)
        in.fail_line(h.lines.at("TYPE"),
                     "the field " + std::string(fields[i]) + " must be one float or double");
      axes += 1u << (4 * (fields[i][0] - 'x'));
      axis_words.emplace_back(point_words - 1, size == 4);
    }
  }
  if (axes != 0x111) in.fail_line(h.lines.at("FIELDS"), "the fields x, y and z must be there, each once");
  const std::uint64_t width = natural("WIDTH", entry("WIDTH")[0]);
  const std::uint64_t height = h.entries.contains("HEIGHT") ? natural("HEIGHT", entry("HEIGHT")[0]) : 1;
  if (width > 0 && height > in.bytes.size() * 256 / width)
    in.fail_line(h.lines.at("WIDTH"), "promises more points than the file has room for");
  const std::uint64_t n = width * height;
  if (h.entries.contains("POINTS") && natural("POINTS", entry("POINTS")[0]) != n)
    in.fail_line(h.lines.at("POINTS"), "POINTS is not WIDTH times HEIGHT, " + std::to_string(n));

  const std::string_view data = entry("DATA")[0], body = std::string_view(in.bytes).substr(h.body);
  const auto short_by = [&](std::uint64_t wanted) {
    in.fail("byte " + std::to_string(in.bytes.size()),
            "the file ends here; " + std::to_string(n) + " points take " + std::to_string(wanted) +
                " bytes of data, and it has " + std::to_string(body.size()));
  };
  if (data == "ascii") {
    Lines lines(body);
    std::string_view line;
    std::vector<std::string_view> w;
    std::uint64_t found = 0;
    while (lines.next(line)) {
      split(line, blanks, w);
      if (w.empty()) continue;
      const std::size_t at = h.line + lines.number();
      if (++found > n)
        in.fail_line(at, "more points than the " + std::to_string(n) + " that the header promises");
      if (w.size() != point_words)
        in.fail_line(at, std::to_string(w.size()) + " values for a point of " + std::to_string(point_words));
      for (const auto word : w)
        if (!number<double>(word)) in.fail_line(at, in_quotes(word) + " is not a number");
      for (const auto& [word, is_float] : axis_words) {
        const double value = *number<double>(w[word]);
        if (beyond_float(value)) in.fail_line(at, in_quotes(w[word]) + " is beyond the range of float");
        if (is_float && std::isfinite(value))
          rounded = std::max(rounded, std::abs(value - double(*number<float>(w[word]))));
      }
    }
    if (found < n)
      in.fail_line(h.line + lines.number(),
                   "the file ends after " + std::to_string(found) + " of " + std::to_string(n) + " points");
  } else if (data == "binary") {
    if (body.size() < n * point_bytes) short_by(n * point_bytes);
  } else if (data == "binary_compressed") {
    std::uint32_t packed = 0, unpacked = 0;
    if (body.size() < 8) short_by(8);
    std::memcpy(&packed, body.data(), 4);
    std::memcpy(&unpacked, body.data() + 4, 4);
    if (packed > body.size() - 8) short_by(8 + std::uint64_t{packed});
    if (unpacked != n * point_bytes)
      in.fail("byte " + std::to_string(h.body + 4), "unpacks to " + std::to_string(unpacked) +
                                                        " bytes, and " + std::to_string(n) + " points take " +
                                                        std::to_string(n * point_bytes));
    const auto size = unpacked_size(body.substr(8, packed));
    if (size != unpacked)
      in.fail("byte " + std::to_string(h.body + 8), size ? "its data unpack to " + std::to_string(*size) +
                                                               " bytes instead of " + std::to_string(unpacked)
                                                         : "its packed data are broken");
  } else {
    in.fail_line(h.line, "unknown kind of data " + in_quotes(data));
  }
  if (n == 0) in.fail("", "holds no points");

  PlainHeader plain;
  for (std::size_t i = 0; i < fields.size(); ++i)
    plain.add(fields[i], natural("SIZE", sizes[i]), counts ? natural("COUNT", entry("COUNT")[i]) : 1,
              data == "ascii");
  std::vector<double> xyz;
  if (const std::string problem = pcl_read_pcd(plain.text(n, data), body, xyz); !problem.empty())
    in.fail("", problem);
  if (xyz.size() != 3 * n)
    in.fail("", "PCL read " + std::to_string(xyz.size() / 3) + " of " + std::to_string(n) + " points");
  Raw r;
  r.rounded = rounded;
  r.points.resize(n);
  for (std::size_t i = 0; i < n; ++i) r.points[i] = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
  return r;
}

}  // namespace treeline::datasets::files
