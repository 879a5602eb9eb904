// PLY (Turk 1994): header, then elements in order, as text or as binary of either byte order.
// Every element is walked, so a wrong count, a short file or a bad index is found with its place.
#include <algorithm>
#include <bit>
#include <cstring>

#include "datasets_gen/files/input.hpp"

namespace treeline::datasets::files {
namespace {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

std::optional<Type> type_named(std::string_view name) {
  static constexpr std::pair<std::string_view, Type> names[] = {
      {"char", Type::i8},   {"int8", Type::i8},     {"uchar", Type::u8},   {"uint8", Type::u8},
      {"short", Type::i16}, {"int16", Type::i16},   {"ushort", Type::u16}, {"uint16", Type::u16},
      {"int", Type::i32},   {"int32", Type::i32},   {"uint", Type::u32},   {"uint32", Type::u32},
      {"float", Type::f32}, {"float32", Type::f32}, {"double", Type::f64}, {"float64", Type::f64}};
  for (const auto& [n, t] : names)
    if (n == name) return t;
  return std::nullopt;
}
constexpr std::size_t size_of(Type t) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(t)];
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  // of a list
  int axis = -1;              // 0, 1, 2 for x, y, z of a vertex
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::vector<Element> elements;
  bool binary = false, big_endian = false;
  std::size_t lines = 0;
  std::size_t body = 0;  // its first byte
};

Header read_header(const Input& in) {
  Header h;
  Lines lines(in.bytes);
  std::string_view line;
  std::vector<std::string_view> w;
  if (!lines.next(line) || line != "ply")
    in.fail_line(1, "a PLY file starts with 'ply'; this is " + in_quotes(line));
  bool format = false;
  while (lines.next(line)) {
    split(line, blanks, w);
    const auto fail = [&](const std::string& problem) { in.fail_line(lines.number(), problem); };
    if (w.empty() || w[0] == "comment" || w[0] == "obj_info") continue;
    if (w[0] == "end_header") {
      if (!format) fail("the header names no format");
      h.lines = lines.number();
      h.body = in.bytes.size() - lines.rest().size();
      return h;
    }
    if (w[0] == "format") {
      if (w.size() != 3 || w[2] != "1.0") fail("expected 'format KIND 1.0'");
      if (w[1] != "ascii" && w[1] != "binary_little_endian" && w[1] != "binary_big_endian")
        fail("unknown format " + in_quotes(w[1]));
      h.binary = w[1] != "ascii", h.big_endian = w[1] == "binary_big_endian", format = true;
    } else if (w[0] == "element") {
      const auto count = w.size() == 3 ? number<std::uint64_t>(w[2]) : std::nullopt;
      if (!count) fail("expected 'element NAME COUNT'");
      h.elements.push_back({std::string(w[1]), static_cast<std::size_t>(*count), {}});
    } else if (w[0] == "property") {
      if (h.elements.empty()) fail("a property before any element");
      const bool list = w.size() == 5 && w[1] == "list";
      if (!list && w.size() != 3) fail("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
      const auto type = type_named(w[list ? 3 : 1]);
      const auto count = list ? type_named(w[2]) : std::nullopt;
      if (!type || (list && !count)) fail("unknown type in " + in_quotes(line));
      Property p{std::string(w.back()), *type, count};
      if (h.elements.back().name == "vertex" && !list && p.name.size() == 1 && p.name[0] >= 'x' &&
          p.name[0] <= 'z')
        p.axis = p.name[0] - 'x';
      h.elements.back().properties.push_back(std::move(p));
    } else {
      fail("unknown header line " + in_quotes(line));
    }
  }
  in.fail_line(lines.number(), "the file ends within the header, before 'end_header'");
}

bool is_corner_list(const Element& e, const Property& p) {
  return e.name == "face" && p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
}

/// Reads one value after the other, from text or binary; knows where it is.
class Values {
 public:
  Values(const Input& in, const Header& h)
      : in_(in), header_(h), lines_(std::string_view(in.bytes).substr(h.body)), at_(h.body) {}

  void begin(const Element& e, std::size_t index) {
    element_ = &e, index_ = index, word_ = 0;
    if (header_.binary) return;
    std::string_view line;
    do {
      if (!lines_.next(line)) fail("the file ends here; the header promises " + std::to_string(e.count));
      split(line, blanks, words_);
    } while (words_.empty());
  }
  void end() {
    if (!header_.binary && word_ < words_.size()) fail("more values than the header's properties");
  }
  void finish() {
    if (header_.binary) {
      if (at_ != in_.bytes.size())
        in_.fail("byte " + std::to_string(at_),
                 std::to_string(in_.bytes.size() - at_) +
                     " bytes follow the last element that the header promises");
      return;
    }
    for (std::string_view line; lines_.next(line);)
      if (split(line, blanks, words_), !words_.empty())
        in_.fail_line(header_.lines + lines_.number(),
                      "values follow the last element that the header promises");
  }

  double next(Type type, float* rounded = nullptr) {
    const double value = header_.binary ? binary(type) : text(type, rounded);
    if (header_.binary && rounded) *rounded = static_cast<float>(value);
    return value;
  }
  /// Skips a list or takes it, after checking that it fits into the file.
  std::size_t count(Type type) {
    const double n = next(type);
    if (!(n >= 0) || n != std::floor(n)) fail("a list of length " + std::to_string(n));
    const std::size_t room = header_.binary ? in_.bytes.size() - at_ : words_.size() - word_;
    if (n > static_cast<double>(room))
      fail("a list of length " + (n < 0x1p53 ? std::to_string(std::size_t(n)) : std::to_string(n)) +
           " runs past the end");
    return static_cast<std::size_t>(n);
  }
  [[noreturn]] void fail(const std::string& problem) const {
    std::string place = element_->name + " " + std::to_string(index_);
    place += header_.binary ? ", byte " + std::to_string(at_)
                            : ", line " + std::to_string(header_.lines + lines_.number());
    in_.fail(place, problem);
  }

 private:
  double text(Type type, float* rounded) {
    if (word_ >= words_.size()) fail("fewer values than the header's properties");
    const std::string_view word = words_[word_++];
    const auto value = number<double>(word);
    if (!value || !std::isfinite(*value)) fail(in_quotes(word) + " is not a number that PLY text can hold");
    if (type != Type::f32 && type != Type::f64 && *value != std::floor(*value))
      fail(in_quotes(word) + " is not an integer");
    if (rounded) *rounded = number<float>(word).value_or(0);
    return *value;
  }
  double binary(Type type) {
    const std::size_t size = size_of(type);
    if (in_.bytes.size() - at_ < size)
      fail("the file ends here; the header promises " + std::to_string(element_->count) + " of these");
    unsigned char b[8];
    const bool swap = header_.big_endian == (std::endian::native == std::endian::little);
    for (std::size_t i = 0; i < size; ++i)
      b[i] = static_cast<unsigned char>(in_.bytes[at_ + (swap ? size - 1 - i : i)]);
    at_ += size;
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, b, sizeof value);
      return static_cast<double>(value);
    };
    switch (type) {
      case Type::i8:
        return as(std::int8_t{});
      case Type::u8:
        return as(std::uint8_t{});
      case Type::i16:
        return as(std::int16_t{});
      case Type::u16:
        return as(std::uint16_t{});
      case Type::i32:
        return as(std::int32_t{});
      case Type::u32:
        return as(std::uint32_t{});
      case Type::f32:
        return as(float{});
      default:
        return as(double{});
    }
  }

  const Input& in_;
  const Header& header_;
  Lines lines_;
  std::size_t at_;
  std::vector<std::string_view> words_;
  std::size_t word_ = 0;
  const Element* element_ = nullptr;
  std::size_t index_ = 0;
};

void check_meaning(const Input& in, const Header& h) {
  int axes = 0, vertices = 0, faces = 0;
  for (const Element& e : h.elements) {
    if (e.name == "vertex") {
      ++vertices;
      for (const Property& p : e.properties) axes += p.axis >= 0 ? 1 << (4 * p.axis) : 0;
    }
    if (e.name == "face") {
      ++faces;
      if (vertices == 0) in.fail("header", "the faces come before the vertices");
      if (e.count > 0 &&
          std::ranges::count_if(e.properties, [&](const auto& p) { return is_corner_list(e, p); }) != 1)
        in.fail("header", "the faces have no list called vertex_indices or vertex_index");
    }
    if (e.name == "tristrips" && e.count > 0)
      in.fail("header",
              "keeps triangles in strips (element 'tristrips'), which are not read; save them as faces");
    if (e.properties.empty() && e.count > 0)
      in.fail("header", "element " + in_quotes(e.name) + " has no properties");
  }
  if (vertices != 1) in.fail("header", "there must be one element called vertex");
  if (faces > 1) in.fail("header", "there is more than one element called face");
  if (axes != 0x111) in.fail("header", "the vertices need the properties x, y and z, each once");
}

/// The same vertices and faces with nothing else, as binary PLY: all that OpenMesh gets to see. Other
/// properties of faces it would take for corners or skip by the wrong width; a line of CR and LF, for data.
class Plain {
 public:
  void vertex(const float (&x)[3]) { append(vertices_, x, sizeof x), ++vertex_count_; }
  void face(const std::vector<std::int32_t>& corners) {
    const auto n = static_cast<std::int32_t>(corners.size());
    append(faces_, &n, sizeof n), append(faces_, corners.data(), corners.size() * sizeof(std::int32_t));
    ++face_count_;
  }
  std::string text() const {
    const char* order = std::endian::native == std::endian::little ? "little" : "big";
    return "ply\nformat binary_" + std::string(order) + "_endian 1.0\nelement vertex " +
           std::to_string(vertex_count_) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
           std::to_string(face_count_) + "\nproperty list int int vertex_indices\nend_header\n" + vertices_ +
           faces_;
  }

 private:
  static void append(std::string& to, const void* bytes, std::size_t n) {
    to.append(static_cast<const char*>(bytes), n);
  }
  std::string vertices_, faces_;
  std::size_t vertex_count_ = 0, face_count_ = 0;
};

}  // namespace

Checked check_ply(const Input& in) {
  const Header h = read_header(in);
  check_meaning(in, h);
  Checked r;
  r.binary = true, r.is_mesh = false;
  Values values(in, h);
  Plain plain;
  std::vector<std::int32_t> face;
  for (const Element& e : h.elements) {
    const bool has_doubles = std::ranges::any_of(
        e.properties, [](const Property& p) { return p.axis >= 0 && p.type == Type::f64; });
    if (e.name == "vertex") r.vertices = e.count;
    if (e.name == "face") r.polygons = e.count, r.is_mesh = e.count > 0;
    for (std::size_t i = 0; i < e.count; ++i) {
      values.begin(e, i);
      float point[3]{};
      geometry::Vec3d exact;
      face.clear();
      for (const Property& p : e.properties) {
        float rounded = 0;
        const std::size_t n = p.count ? values.count(*p.count) : 1;
        const bool corners = is_corner_list(e, p);
        if (corners && n < 3) values.fail("a face of " + std::to_string(n) + " corners");
        for (std::size_t k = 0; k < n; ++k) {
          const double v = values.next(p.type, p.axis >= 0 ? &rounded : nullptr);
          if (p.axis >= 0 && !r.coordinates.add(p.axis, v, rounded))
            values.fail("a coordinate beyond the range of float");
          if (p.axis >= 0) point[p.axis] = rounded, exact[p.axis] = v;
          if (corners && !(v >= 0 && v < static_cast<double>(r.vertices)))
            values.fail("names vertex " + std::to_string(static_cast<long long>(v)) + " of " +
                        std::to_string(r.vertices) + " (counted from 0)");
          if (corners && v != std::floor(v)) values.fail("names vertex " + std::to_string(v));
          if (corners) face.push_back(static_cast<std::int32_t>(v));
        }
      }
      values.end();
      if (has_doubles && e.name == "vertex") r.doubles.push_back(exact);
      if (e.name == "vertex") plain.vertex(point);
      if (e.name == "face") plain.face(face);
    }
  }
  values.finish();
  r.text = plain.text();
  return r;
}

}  // namespace treeline::datasets::files
