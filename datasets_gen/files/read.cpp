#include "datasets_gen/files/read.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "datasets_gen/files/images.hpp"
#include "datasets_gen/files/input.hpp"
#include "geometry/adjacency.hpp"

namespace treeline::datasets {
namespace files {
namespace {

constexpr std::string_view known_extensions = "ply, obj, stl, off, gltf, glb, pcd, xyz, txt, csv, and images";

/// Images that are known by name where no package can read them.
[[maybe_unused]] constexpr std::string_view common_images[] = {"png",  "exr", "hdr", "jpg",  "jpeg", "tif",
                                                               "tiff", "tga", "bmp", "webp", "ppm",  "pfm"};

/// Geometry, whatever else OpenImageIO might read under these names.
[[maybe_unused]] constexpr std::string_view own_extensions[] = {"ply", "obj", "stl", "off", "gltf",
                                                                "glb", "pcd", "xyz", "txt", "csv"};

/// Float rounds a coordinate by at most this share of the extent before a note is due.
constexpr double noted_rounding = 1e-6;

[[maybe_unused, noreturn]] void not_built(const Input& in, const char* package) {
  in.fail("", std::string("reading this format needs ") + package + ", which this program was built without");
}

Input load(const std::filesystem::path& path) {
  Input in{path, {}};
  std::error_code error;
  if (!std::filesystem::exists(path, error)) in.fail("", "no such file");
  if (!std::filesystem::is_regular_file(path, error)) in.fail("", "not a regular file");
  const auto size = std::filesystem::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream) in.fail("", "cannot be opened for reading");
  if (size == 0) in.fail("", "the file is empty");
  try {
    in.bytes.resize(size);
  } catch (const std::exception&) {
    in.fail("", "has " + std::to_string(size) + " bytes, more than there is memory for");
  }
  if (!stream.read(in.bytes.data(), static_cast<std::streamsize>(size)))
    in.fail("byte " + std::to_string(stream.gcount()), "reading stops here");
  return in;
}

/// Formats that are text, or at least begin as text.
constexpr std::string_view markable[] = {"ply", "obj", "off", "xyz", "txt", "csv"};
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

void take_mark_off(Input& in, const std::string& extension) {
  if (!in.bytes.starts_with(byte_order_mark) || std::ranges::find(markable, extension) == std::end(markable))
    return;
  in.bytes.erase(0, byte_order_mark.size());
  in.marked = true;
}

/// What a file is that has another name than its content deserves.
void refuse_disguised(const Input& in) {
  static constexpr std::pair<std::string_view, const char*> starts[] = {
      {"\xFF\xFE", "is text in UTF-16; save it as UTF-8"},
      {"\xFE\xFF", "is text in UTF-16; save it as UTF-8"},
      {"\x1F\x8B", "is compressed by gzip; unpack it first"},
      {"PK\x03\x04", "is a zip archive; unpack it first"},
      {"\xFD"
       "7zXZ",
       "is compressed by xz; unpack it first"},
      {"BZh", "is compressed by bzip2; unpack it first"},
      {"\x28\xB5\x2F\xFD", "is compressed by zstd; unpack it first"}};
  for (const auto& [start, problem] : starts)
    if (in.bytes.starts_with(start)) in.fail("byte 0", problem);
}

struct Loaded {
  Raw raw;
  Coordinates coordinates;  // from the check, where the library gives floats only
  std::vector<geometry::Vec3d> doubles{};
};

Loaded load_openmesh([[maybe_unused]] const Input& in, [[maybe_unused]] const std::string& extension) {
#ifdef TREELINE_HAVE_OPENMESH
  Checked checked = extension == "ply"   ? check_ply(in)
                    : extension == "obj" ? check_obj(in)
                    : extension == "off" ? check_off(in)
                                         : check_stl(in);
  return {read_openmesh(in, extension, checked), checked.coordinates, std::move(checked.doubles)};
#else
  not_built(in, "OpenMesh");
#endif
}

Loaded load_by(const Input& in, const std::string& extension) {
  if (extension == "ply" || extension == "obj" || extension == "off" || extension == "stl")
    return load_openmesh(in, extension);
  if (extension == "xyz" || extension == "txt" || extension == "csv") return {read_xyz(in), {}};
  if (extension == "gltf" || extension == "glb") {
#ifdef TREELINE_HAVE_ASSIMP
    return {read_assimp(in), {}};
#else
    not_built(in, "assimp");
#endif
  }
  if (extension == "pcd") {
#ifdef TREELINE_HAVE_PCL
    return {read_pcd(in), {}};
#else
    not_built(in, "PCL");
#endif
  }
#ifndef TREELINE_HAVE_OPENIMAGEIO
  if (std::ranges::find(common_images, extension) != std::end(common_images)) not_built(in, "OpenImageIO");
#endif
  in.fail("", extension.empty()
                  ? "has no extension to tell its format by; known: " + std::string(known_extensions)
                  : "unknown extension ." + extension + "; known: " + std::string(known_extensions));
}

/// Whether float keeps so little of the coordinates that their doubles are worth keeping, too.
bool rounds_too_coarsely(const Coordinates& c) {
  const auto sides = c.box.extent();
  const double extent = std::max({sides[0], sides[1], sides[2]});
  return extent > 0 && c.largest_error > noted_rounding * extent;
}

std::string short_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", x);
  return text;
}

/// What float made of the coordinates and what helps. `kept`: their doubles are kept beside the floats.
std::string rounding_note(const Coordinates& c, bool kept, bool is_mesh) {
  const auto sides = c.box.extent();
  const double extent = std::max({sides[0], sides[1], sides[2]});
  const double share = c.largest_error / extent;
  const std::string moved = "by up to " + short_number(c.largest_error) + " (" + short_number(share) +
                            (share < 0.95 ? " of the extent)" : " times the extent)");
  if (kept) return "float would move coordinates " + moved + ": they are kept as doubles";
  // Whole, unless that leaves more than the extent's size.
  const double step = extent < 1 ? std::pow(10.0, std::floor(std::log10(extent))) : 1;
  std::string offset;
  bool helps = false;
  for (int k = 0; k < 3; ++k) {
    const double low = std::floor(c.box.low[k] / step) * step;
    helps = helps || low != 0;
    char text[64];
    std::snprintf(text, sizeof text, " %.15g", low);
    offset += text;
  }
  const std::string what = "coordinates were rounded to float, which moved them " + moved + ", since " +
                           (is_mesh ? "meshes are kept as floats" : "the file declares floats");
  // Near the origin only numbers too small for float lose that much.
  if (!helps) return what + ": take a smaller unit";
  return what + (is_mesh ? ". Subtract" : ". Declare doubles, or subtract") +
         " an offset from all points, such as" + offset;
}

/// What the points that are not finite take with them.
std::string left_out(const Raw& raw, const std::vector<geometry::Vec3f>& points) {
  if (!raw.is_mesh) return "";
  const auto faces = std::ranges::count_if(raw.faces, [&](const auto& face) {
    return std::ranges::any_of(face, [&](std::uint32_t v) { return !geometry::is_finite(points[v]); });
  });
  if (faces == 0) return "; no face has a corner there";
  return faces == 1 ? "; 1 triangle has a corner there and is left out of every answer"
                    : "; " + std::to_string(faces) +
                          " triangles have a corner there and are left out of every answer";
}

/// Rounds to float, and notes what got lost.
std::vector<geometry::Vec3f> to_float(const Input& in, const Raw& raw, Coordinates& c, Dataset& to) {
  const bool measured = !c.box.empty();
  std::vector<geometry::Vec3f> r(raw.points.size());
  std::size_t odd = 0, first_odd = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    r[i] = geometry::Vec3f(raw.points[i]);
    for (int k = 0; k < 3; ++k)
      if (!measured && !c.add(k, raw.points[i][k], r[i][k]))
        in.fail("point " + std::to_string(i), "a coordinate beyond the range of float");
    if (!geometry::is_finite(r[i]) && odd++ == 0) first_odd = i;
  }
  if (odd > 0)
    to.notes.push_back((odd == 1 ? "1 point has" : std::to_string(odd) + " points have") +
                       " a coordinate that is not finite" +
                       (odd == 1 ? ": number " : ", the first is number ") + std::to_string(first_odd) +
                       " (counted from 0)" + left_out(raw, r));
  return r;
}

}  // namespace
}  // namespace files

Dataset read(const std::filesystem::path& path) {
  files::Input in = files::load(path);
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  files::take_mark_off(in, extension);
  // A binary STL may start with anything; 80 bytes of it are a comment.
  if (extension != "stl") files::refuse_disguised(in);
#ifdef TREELINE_HAVE_OPENIMAGEIO
  if (std::ranges::find(files::own_extensions, extension) == std::end(files::own_extensions) &&
      files::is_image_extension(extension))
    return files::read_image(in);
#endif

  files::Loaded loaded;
  try {
    loaded = files::load_by(in, extension);
  } catch (const std::bad_alloc&) {
    in.fail("", "there is not enough memory to read it");
  }
  files::Raw& raw = loaded.raw;
  if (raw.points.empty()) in.fail("", "holds no points");
  if (raw.points.size() > 0xfffffffeu || raw.faces.size() > 0xffffffffu / 3)
    in.fail("", "holds more than 2^32 - 2 points, or a third as many triangles");

  const bool holds_doubles = loaded.coordinates.box.empty();  // else the library rounded before we did
  const std::vector<geometry::Vec3d>& doubles = holds_doubles ? raw.points : loaded.doubles;
  Dataset r;
  r.name = path.filename().string();
  r.notes = std::move(raw.notes);
  std::vector<geometry::Vec3f> points = files::to_float(in, raw, loaded.coordinates, r);
  files::Coordinates& moved = loaded.coordinates;
  const bool kept = !raw.is_mesh && !doubles.empty() && files::rounds_too_coarsely(moved);
  moved.largest_error = std::max(moved.largest_error, raw.rounded);
  if (files::rounds_too_coarsely(moved)) r.notes.push_back(files::rounding_note(moved, kept, raw.is_mesh));
  r.rounding = moved.largest_error;
  if (!raw.is_mesh) {
    r.kind = Kind::cloud;
    r.cloud.points = std::move(points);
    if (kept) r.precise.points = doubles;
    return r;
  }
  if (raw.faces.empty()) in.fail("", "holds no triangle");
  r.kind = Kind::mesh;
  r.mesh.vertices = std::move(points);
  r.mesh.faces = std::move(raw.faces);
  const geometry::Adjacency adjacency(r.mesh);
  r.closed = adjacency.closed() && adjacency.oriented();
  return r;
}

}  // namespace treeline::datasets
