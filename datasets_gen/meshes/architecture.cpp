// A large building: walls and floors the size of the site, beside cables, beams and columns of long thin
// triangles, and ornament a thousand times smaller. Faces lie in axis-aligned planes, boxes overlap, sizes
// differ by 1e4: what midpoint splits and object splits do worst on.
//
// A site (ground, outer walls, floors) comes first; then bays of equal face count, each a window wall,
// frames, a railing, columns with ornate capitals, and cables that run across the site. The last bay is cut
// short to come near n. Units: metres. Open and self-intersecting, as real building models are.
#include <algorithm>

#include "datasets_gen/recipe.hpp"

namespace treeline::datasets {
namespace {

constexpr Vec3d bay_size{8, 6, 4};

class Builder {
 public:
  geometry::Mesh3f mesh;

  std::uint32_t point(const Vec3d& p) {
    mesh.vertices.push_back(rounded(p));
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  }
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  }
  /// A box from a corner and three edges.
  void block(const Vec3d& o, const Vec3d& x, const Vec3d& y, const Vec3d& z) {
    std::uint32_t v[8];
    for (int k = 0; k < 8; ++k) {
      Vec3d p = o;
      if (k & 1) p = sum(p, x);
      if (k & 2) p = sum(p, y);
      if (k & 4) p = sum(p, z);
      v[k] = point(p);
    }
    quad(v[0], v[2], v[3], v[1]), quad(v[4], v[5], v[7], v[6]);
    quad(v[0], v[1], v[5], v[4]), quad(v[2], v[6], v[7], v[3]);
    quad(v[0], v[4], v[6], v[2]), quad(v[1], v[3], v[7], v[5]);
  }
  void upright_block(const Vec3d& low, const Vec3d& size) {
    block(low, {size[0], 0, 0}, {0, size[1], 0}, {0, 0, size[2]});
  }
  /// A square bar of the given thickness between two points.
  void bar(const Vec3d& from, const Vec3d& to, double thickness) {
    const Vec3d along = sum(to, scaled(from, -1)), unit = unit_portable(along);
    const Vec3d other = std::abs(unit[2]) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
    const Vec3d x = unit_portable(cross_portable(unit, other)), y = cross_portable(unit, x);
    const Vec3d corner = sum(from, scaled(sum(x, y), -0.5 * thickness));
    block(corner, scaled(x, thickness), scaled(y, thickness), along);
  }
  /// A surface of revolution about a vertical axis: rings of `sides` points at the given radii and heights.
  template <class Radius, class Height>
  void lathe(const Vec3d& foot, int sides, int rings, const Radius& radius, const Height& height) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int r = 0; r <= rings; ++r)
      for (int s = 0; s < sides; ++s) {
        const SinCos a = sincos_turns(static_cast<double>(s) / sides);
        point(sum(foot, {radius(r) * a.cos, radius(r) * a.sin, height(r)}));
      }
    const auto at = [&](int r, int s) { return first + static_cast<std::uint32_t>(r * sides + s % sides); };
    for (int r = 0; r < rings; ++r)
      for (int s = 0; s < sides; ++s) quad(at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s));
  }
};

struct Site {
  std::size_t wide = 1, deep = 1, storeys = 1;  // in bays

  explicit Site(std::size_t bays) {
    while ((storeys + 1) * (storeys + 1) * (storeys + 1) * 4 <= bays) ++storeys;
    while (wide * wide * storeys < bays) ++wide;
    while (wide * deep * storeys < bays) ++deep;
  }
  Vec3d size() const {
    return {bay_size[0] * double(wide), bay_size[1] * double(deep), bay_size[2] * double(storeys)};
  }
};

void add_site(Builder& to, const Site& site) {
  const Vec3d s = site.size();
  constexpr double wall = 0.3;
  to.upright_block({-20, -20, -1}, {s[0] + 40, s[1] + 40, 0.5});
  to.upright_block({-wall, -wall, 0}, {wall, s[1] + 2 * wall, s[2]});
  to.upright_block({s[0], -wall, 0}, {wall, s[1] + 2 * wall, s[2]});
  to.upright_block({0, s[1], 0}, {s[0], wall, s[2]});
  for (std::size_t k = 0; k <= site.storeys; ++k)
    to.upright_block({0, 0, bay_size[2] * double(k) - 0.2}, {s[0], s[1], 0.2});
}

/// A thin bar from anywhere to anywhere.
void add_cable(Builder& to, const Site& site, Draws& draws) {
  const Vec3d a = draws.in_box({0, 0, 0}, site.size()), b = draws.in_box({0, 0, 0}, site.size());
  to.bar(a, b, 0.01);
}

/// Adds the parts that fit into `limit` faces; a full bay has the same number of faces and vertices
/// every time.
void add_bay(Builder& to, const Site& site, std::size_t number, std::uint64_t seed, std::size_t limit) {
  Draws draws(seed, number);
  const Vec3d o{bay_size[0] * double(number % site.wide),
                bay_size[1] * double(number / site.wide % site.deep),
                bay_size[2] * double(number / (site.wide * site.deep))};
  const auto room = [&](std::size_t faces) { return to.mesh.faces.size() + faces <= limit; };
  const auto at = [&](double x, double y, double z) { return sum(o, {x, y, z}); };

  for (int k = 0; k < 4 && room(12); ++k) add_cable(to, site, draws);
  // The window wall: four panels about an opening, and its frame.
  const double left = draws.uniform(1, 2.5), right = draws.uniform(5, 7), sill = 0.9,
               head = draws.uniform(2.2, 3.2);
  if (room(12)) to.upright_block(at(0, 0, 0), {left, 0.2, 3.8});
  if (room(12)) to.upright_block(at(right, 0, 0), {8 - right, 0.2, 3.8});
  if (room(12)) to.upright_block(at(left, 0, 0), {right - left, 0.2, sill});
  if (room(12)) to.upright_block(at(left, 0, head), {right - left, 0.2, 3.8 - head});
  for (int k = 0; k <= 6 && room(12); ++k) {
    const double x = left + (right - left) * k / 6;
    to.bar(at(x, 0.1, sill), at(x, 0.1, head), 0.03);
  }
  for (int k = 0; k <= 4 && room(12); ++k) {
    const double z = sill + (head - sill) * k / 4;
    to.bar(at(left, 0.1, z), at(right, 0.1, z), 0.03);
  }
  // The railing: a long rail on thin posts.
  if (room(12)) to.bar(at(0, 5.5, 1), at(8, 5.5, 1), 0.05);
  for (int k = 0; k < 20 && room(12); ++k)
    to.bar(at(0.2 + 0.4 * k, 5.5, 0), at(0.2 + 0.4 * k, 5.5, 1), 0.015);
  // Two columns: smooth shafts of long thin triangles, fluted capitals of tiny ones.
  for (int k = 0; k < 2; ++k) {
    const Vec3d foot = at(1 + 4 * k, 4 + draws.uniform(), 0);
    if (room(64))
      to.lathe(
          foot, 32, 1, [](int r) { return 0.25 - 0.03 * r; }, [](int r) { return 3.5 * r; });
    if (room(384))
      to.lathe(
          foot, 24, 8, [](int r) { return r % 2 == 0 ? 0.24 + 0.01 * r : 0.2; },
          [](int r) { return 3.5 + 0.0375 * r; });
  }
}

}  // namespace

geometry::Mesh3f architecture(const Job& job) {
  Builder sample;
  add_bay(sample, Site(1), 0, 0, SIZE_MAX);
  const std::size_t bay_faces = sample.mesh.faces.size(), bay_vertices = sample.mesh.vertices.size();

  const std::size_t bays = job.n / bay_faces + 1;
  const Site site(bays);
  Builder base;
  add_site(base, site);
  const std::size_t rest = job.n - std::min(job.n, base.mesh.faces.size());
  const std::size_t full = rest / bay_faces;
  const std::size_t first_vertex = base.mesh.vertices.size(), first_face = base.mesh.faces.size();

  geometry::Mesh3f mesh = std::move(base.mesh);
  mesh.vertices.resize(first_vertex + full * bay_vertices);
  mesh.faces.resize(first_face + full * bay_faces);
  const auto place = [&](const geometry::Mesh3f& bay, std::size_t vertex, std::size_t face) {
    std::ranges::copy(bay.vertices, mesh.vertices.begin() + static_cast<std::ptrdiff_t>(vertex));
    for (const auto& f : bay.faces) {
      const auto shift = static_cast<std::uint32_t>(vertex);
      mesh.faces[face++] = {f[0] + shift, f[1] + shift, f[2] + shift};
    }
  };
  job.each(
      full,
      [&](std::size_t k) {
        Builder bay;
        add_bay(bay, site, k, job.seed, SIZE_MAX);
        place(bay.mesh, first_vertex + k * bay_vertices, first_face + k * bay_faces);
      },
      1, 4);
  Builder last;
  const std::size_t left = rest - full * bay_faces;
  add_bay(last, site, full, job.seed, left);
  Draws draws(job.seed, full + 1);
  while (last.mesh.faces.size() + 6 <= left) add_cable(last, site, draws);  // what no larger part fits into
  const std::size_t vertex = mesh.vertices.size(), face = mesh.faces.size();
  mesh.vertices.resize(vertex + last.mesh.vertices.size());
  mesh.faces.resize(face + last.mesh.faces.size());
  place(last.mesh, vertex, face);
  return mesh;
}

}  // namespace treeline::datasets
