#include "datasets_gen/files/write.hpp"

#ifdef TREELINE_HAVE_OPENIMAGEIO
#include "datasets_gen/files/images.hpp"
#endif

#include <bit>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>

namespace treeline::datasets {
namespace {

static_assert(std::endian::native == std::endian::little, "binary files are written as the memory has them");

/// Collects bytes and passes them on in large pieces.
class Sink {
 public:
  explicit Sink(std::ofstream& to) : to_(to) {}
  ~Sink() { flush(); }

  Sink& operator<<(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() > (1u << 20)) flush();
    return *this;
  }
  Sink& operator<<(std::size_t value) { return *this << std::string_view(std::to_string(value)); }
  /// Shortest decimal that reads back as the same number.
  template <class T>
  requires std::is_floating_point_v<T> Sink& operator<<(T value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    return *this << std::string_view(text, static_cast<std::size_t>(end - text));
  }
  template <class T>
  void raw(const T& value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    *this << std::string_view(bytes, sizeof value);
  }
  template <class Point>
  void line(std::string_view start, const Point& p, std::string_view separator = " ") {
    *this << start << p[0] << separator << p[1] << separator << p[2] << std::string_view("\n");
  }

 private:
  void flush() { to_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size())), buffer_.clear(); }

  std::ofstream& to_;
  std::string buffer_;
};

const std::vector<geometry::Vec3f>& points_of(const Dataset& d) {
  return d.kind == Kind::cloud ? d.cloud.points : d.mesh.vertices;
}

/// Calls put(points) with the doubles of a dataset that has them, else with its floats.
template <class Put>
void with_points(const Dataset& d, const Put& put) {
  d.precise.size() > 0 ? put(d.precise.points) : put(points_of(d));
}

void write_ply(const Dataset& d, Sink& to) {
  const std::string_view type = d.precise.size() > 0 ? "double" : "float";
  to << "ply\nformat binary_little_endian 1.0\ncomment treeline " << d.name << " seed " << std::size_t{d.seed}
     << "\nelement vertex " << points_of(d).size() << "\n";
  for (const std::string_view axis : {"x", "y", "z"}) to << "property " << type << " " << axis << "\n";
  if (d.kind == Kind::mesh)
    to << "element face " << d.mesh.faces.size() << "\nproperty list uchar uint vertex_indices\n";
  to << "end_header\n";
  with_points(d, [&](const auto& points) {
    for (const auto& p : points) to.raw(p);
  });
  for (const auto& f : d.mesh.faces) to.raw(std::uint8_t{3}), to.raw(f);
}

void write_obj(const Dataset& d, Sink& to) {
  to << "# treeline " << d.name << " seed " << std::size_t{d.seed} << "\n";
  with_points(d, [&](const auto& points) {
    for (const auto& p : points) to.line("v ", p);
  });
  for (const auto& f : d.mesh.faces)
    to << "f " << std::size_t{f[0]} + 1 << " " << std::size_t{f[1]} + 1 << " " << std::size_t{f[2]} + 1
       << "\n";
}

void write_pcd(const Dataset& d, Sink& to) {
  const std::size_t n = d.cloud.size();
  to << "# .PCD v0.7 - treeline " << d.name << " seed " << std::size_t{d.seed}
     << "\nVERSION 0.7\nFIELDS x y z\nSIZE " << (d.precise.size() > 0 ? "8 8 8" : "4 4 4")
     << "\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " << n << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << n
     << "\nDATA binary\n";
  with_points(d, [&](const auto& points) {
    for (const auto& p : points) to.raw(p);
  });
}

void write_xyz(const Dataset& d, Sink& to) {
  with_points(d, [&](const auto& points) {
    for (const auto& p : points) to.line("", p);
  });
}

void write_csv(const Dataset& d, Sink& to) {
  to << "x,y,z\n";
  with_points(d, [&](const auto& points) {
    for (const auto& p : points) to.line("", p, ",");
  });
}

/// Makes an empty file beside `path`, under a name that nothing had.
std::filesystem::path make_part(const std::filesystem::path& path) {
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::filesystem::path part = path;
    part += std::string(".").append(std::to_string(random())).append(".part");
    if (std::FILE* file = std::fopen(part.c_str(), "wx")) {  // x: fails where the name is taken
      std::fclose(file);
      return part;
    }
    if (errno != EEXIST) break;
  }
  throw FileError(path, "", "cannot be opened for writing");
}

/// Calls put(file) with the name of an empty file, which then becomes `path`; nothing is left behind if it
/// throws, or returns false.
template <class Put>
void write_whole(const std::filesystem::path& path, bool overwrite, const Put& put) {
  std::error_code error;
  if (!overwrite && std::filesystem::exists(path, error)) throw FileError(path, "", "exists already");
  // Under another name until it is complete.
  const std::filesystem::path part = make_part(path);
  bool good = false;
  try {
    good = put(part);
  } catch (...) {
    std::filesystem::remove(part, error);
    throw;
  }
  if (good) std::filesystem::rename(part, path, error);
  if (!good || error) {
    std::filesystem::remove(part, error);
    throw FileError(path, "", "writing failed; is the disk full?");
  }
}

void write_image_file(const Dataset& dataset, const std::filesystem::path& path, const std::string& extension,
                      bool overwrite) {
  if (extension != ".png" && extension != ".exr")
    throw FileError(path, "", "images are written as .png or .exr");
#ifdef TREELINE_HAVE_OPENIMAGEIO
  write_whole(path, overwrite, [&](const std::filesystem::path& part) {
    files::write_image(dataset.image, part, extension.substr(1), path);
    return true;
  });
#else
  static_cast<void>(dataset), static_cast<void>(overwrite);
  throw FileError(path, "", "writing images needs OpenImageIO, which this program was built without");
#endif
}

}  // namespace

void write(const Dataset& dataset, const std::filesystem::path& path, bool overwrite) {
  if (dataset.kind == Kind::scene || dataset.kind == Kind::room) {  // no format here holds their light
    Dataset mesh;
    mesh.kind = Kind::mesh, mesh.name = dataset.name;
    mesh.mesh = dataset.kind == Kind::scene ? dataset.scene.mesh : dataset.room.mesh;
    return write(mesh, path, overwrite);
  }
  if (dataset.kind == Kind::surface)
    throw FileError(path, "", "'" + dataset.name + "' is a surface, which is no geometry: no file holds it");
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (dataset.kind == Kind::image) return write_image_file(dataset, path, extension, overwrite);
  const bool cloud = dataset.kind == Kind::cloud;
  void (*writer)(const Dataset&, Sink&) = nullptr;
  if (extension == ".ply") writer = write_ply;
  if (extension == ".obj") writer = write_obj;
  if (extension == ".pcd" && cloud) writer = write_pcd;
  if (extension == ".xyz" && cloud) writer = write_xyz;
  if (extension == ".csv" && cloud) writer = write_csv;
  if (dataset.kind == Kind::vectors) throw FileError(path, "", "vectors have no file format here");
  if (!writer)
    throw FileError(path, "",
                    cloud ? "clouds are written as .ply, .obj, .pcd, .xyz or .csv"
                          : "meshes are written as .ply or .obj");
  if (writer == write_obj || writer == write_xyz || writer == write_csv)
    for (std::size_t i = 0; i < points_of(dataset).size(); ++i)
      if (!geometry::is_finite(points_of(dataset)[i]))
        throw FileError(path, "point " + std::to_string(i),
                        "text cannot hold a coordinate that is not finite");

  write_whole(path, overwrite, [&](const std::filesystem::path& part) {
    std::ofstream stream(part, std::ios::binary | std::ios::trunc);
    if (!stream) throw FileError(path, "", "cannot be opened for writing");
    {
      Sink sink(stream);
      writer(dataset, sink);
    }
    stream.close();
    return static_cast<bool>(stream);
  });
}

}  // namespace treeline::datasets
