// PLY, OBJ, OFF and STL through OpenMesh's readers, into plain arrays.
//
// OpenMesh's mesh types keep half-edges, which cannot hold non-manifold faces: they are dropped, or their
// vertices copied. So its readers are given an importer of our own, which takes vertices and faces as they
// come.
#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <fstream>
#include <mutex>
#include <span>
#include <sstream>

#include "datasets_gen/files/input.hpp"
#include "datasets_gen/files/polygon.hpp"

namespace treeline::datasets::files {
namespace {

using namespace OpenMesh;

class Arrays final : public IO::BaseImporter {
 public:
  /// Of vertices from number `own` on each stands for one of the others.
  Arrays(const Input& in, std::size_t own, std::span<const std::uint32_t> stand_ins)
      : in_(in), own_(own), stand_ins_(stand_ins) {}

  std::vector<geometry::Vec3f> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::size_t polygons = 0;
  std::size_t unfilled = 0, first_unfilled = 0;  // polygons that no triangles fill: fans that overlap

  VertexHandle add_vertex(const Vec3f& p) override {
    points.push_back({p[0], p[1], p[2]});
    return VertexHandle(static_cast<int>(points.size() - 1));
  }
  VertexHandle add_vertex() override { return add_vertex(Vec3f(0, 0, 0)); }
  void set_point(VertexHandle v, const Vec3f& p) override {
    points.at(static_cast<std::size_t>(v.idx())) = {p[0], p[1], p[2]};
  }
  FaceHandle add_face(const VHandles& corners) override {
    const auto corner = [&](std::size_t k) {
      const int index = corners[k].idx();
      if (index < 0 || static_cast<std::size_t>(index) >= points.size())
        in_.fail("face " + std::to_string(polygons), "names vertex " + std::to_string(index) + " of " +
                                                         std::to_string(points.size()) + " (counted from 0)");
      const auto named = static_cast<std::size_t>(index);
      if (named >= own_ && named - own_ < stand_ins_.size()) return stand_ins_[named - own_];
      return static_cast<std::uint32_t>(index);
    };
    std::vector<geometry::Vec3f> outline;
    for (std::size_t k = 0; k < corners.size(); ++k) outline.push_back(points[corner(k)]);
    const auto filling = fill_polygon(outline);
    if (!filling && unfilled++ == 0) first_unfilled = polygons;
    for (const auto& [a, b, c] : filling ? *filling : fan(corners.size()))
      triangles.push_back({corner(a), corner(b), corner(c)});
    return FaceHandle(static_cast<int>(polygons++));
  }
  std::size_t n_vertices() const override { return points.size(); }
  std::size_t n_faces() const override { return polygons; }
  std::size_t n_edges() const override { return 0; }

  // Everything else that files hold is not geometry.
  HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
  FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_next(HalfedgeHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_normal(VertexHandle, const Vec3f&) override {}
  void set_normal(VertexHandle, const Vec3d&) override {}
  void set_normal(FaceHandle, const Vec3f&) override {}
  void set_normal(FaceHandle, const Vec3d&) override {}
  void set_color(VertexHandle, const Vec3uc&) override {}
  void set_color(VertexHandle, const Vec4uc&) override {}
  void set_color(VertexHandle, const Vec3f&) override {}
  void set_color(VertexHandle, const Vec4f&) override {}
  void set_color(EdgeHandle, const Vec3uc&) override {}
  void set_color(EdgeHandle, const Vec4uc&) override {}
  void set_color(EdgeHandle, const Vec3f&) override {}
  void set_color(EdgeHandle, const Vec4f&) override {}
  void set_color(FaceHandle, const Vec3uc&) override {}
  void set_color(FaceHandle, const Vec4uc&) override {}
  void set_color(FaceHandle, const Vec3f&) override {}
  void set_color(FaceHandle, const Vec4f&) override {}
  void set_texcoord(VertexHandle, const Vec2f&) override {}
  void set_texcoord(VertexHandle, const Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
  void set_status(VertexHandle, const Attributes::StatusInfo&) override {}
  void set_status(HalfedgeHandle, const Attributes::StatusInfo&) override {}
  void set_status(EdgeHandle, const Attributes::StatusInfo&) override {}
  void set_status(FaceHandle, const Attributes::StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}

 private:
  const Input& in_;
  std::size_t own_;
  std::span<const std::uint32_t> stand_ins_;
};

}  // namespace

Raw read_openmesh(const Input& in, const std::string& format, const Checked& checked) {
  static std::mutex one_at_a_time;  // OpenMesh's readers are single objects with state
  const std::lock_guard lock(one_at_a_time);
  omerr().disable();
  omout().disable();

  Arrays arrays(in, checked.vertices, checked.stand_ins);
  IO::Options options;
  if (checked.binary) options += IO::Options::Binary;
  bool good = false;
  if (checked.text.empty() && !in.marked) {
    std::ifstream stream(in.path, std::ios::binary);
    good = IO::IOManager().read(stream, format, arrays, options);
  } else {
    std::istringstream stream(checked.text.empty() ? in.bytes : checked.text);
    good = IO::IOManager().read(stream, format, arrays, options);
  }
  if (!good) in.fail("", "OpenMesh cannot read it, though its structure is sound");
  if (arrays.polygons != checked.polygons)
    in.fail("", "OpenMesh read " + std::to_string(arrays.polygons) + " of " +
                    std::to_string(checked.polygons) + " faces");

  if (const std::size_t extra = checked.stand_ins.size(); extra > 0 && arrays.points.size() > extra)
    arrays.points.resize(arrays.points.size() - extra);

  if (checked.compare_bits) {
    if (arrays.points.size() != checked.vertices)
      in.fail("", "OpenMesh read " + std::to_string(arrays.points.size()) + " of " +
                      std::to_string(checked.vertices) + " vertices");
    std::uint64_t bits = 0;
    for (const auto& p : arrays.points)
      for (int k = 0; k < 3; ++k) bits += Coordinates::bits_of(p[k]);
    if (bits != checked.coordinates.bits) in.fail("", "OpenMesh read other coordinates than the file holds");
  }

  Raw r;
  r.is_mesh = checked.is_mesh;
  r.notes = checked.notes;
  r.faces = std::move(arrays.triangles);
  r.points.reserve(arrays.points.size());
  for (const auto& p : arrays.points) r.points.push_back(geometry::Vec3d(p));
  if (checked.dropped > 0)
    r.notes.push_back("left out " + std::to_string(checked.dropped) +
                      " faces of fewer than three different corners");
  if (arrays.unfilled > 0)
    r.notes.push_back(
        std::to_string(arrays.unfilled) +
        (arrays.unfilled == 1 ? " polygon crosses itself or is" : " polygons cross themselves or are") +
        " not convex with more than " + std::to_string(most_concave_corners) +
        " corners: cut into triangles that overlap; the first is face " +
        std::to_string(arrays.first_unfilled) + " of the file (counted from 0)");
  return r;
}

}  // namespace treeline::datasets::files
