#include "datasets_gen/meshes/damage.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "geometry/adjacency.hpp"
#include "geometry/random.hpp"

namespace treeline::datasets {
namespace {

using geometry::Mesh3f;
using Face = Mesh3f::Face;

constexpr std::array<std::pair<std::string_view, DamageKind>, 8> names{
    {{"hole", DamageKind::hole},
     {"missing", DamageKind::missing},
     {"flipped", DamageKind::flipped},
     {"duplicated", DamageKind::duplicated},
     {"degenerate", DamageKind::degenerate},
     {"unwelded", DamageKind::unwelded},
     {"inside_out", DamageKind::inside_out},
     {"nested", DamageKind::nested}}};

bool takes_fraction(DamageKind kind) { return kind <= DamageKind::degenerate; }

/// So many faces, spread at random: those of smallest hash.
std::vector<bool> chosen(std::size_t n, std::size_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(geometry::hash_u64(seed, i), i); });
  std::vector<bool> r(n);
  for (std::size_t k = 0; k < count; ++k) r[order[k]] = true;
  return r;
}

/// So many faces around one drawn at random, nearest first by steps over edges; where its part of the mesh is
/// too small, around another one, too.
std::vector<bool> neighbourhood(const Mesh3f& mesh, std::size_t count, std::uint64_t seed) {
  const geometry::Adjacency adjacency(mesh);
  std::vector<bool> taken(mesh.size());
  std::vector<std::uint32_t> queue;
  for (std::uint64_t draw = 0; queue.size() < count; ++draw) {
    auto start = static_cast<std::uint32_t>(geometry::hash_u64(seed, draw) % mesh.size());
    while (taken[start]) start = start + 1 == mesh.size() ? 0 : start + 1;
    std::size_t next = queue.size();
    queue.push_back(start), taken[start] = true;
    for (; next < queue.size() && queue.size() < count; ++next)
      for (int side = 0; side < 3 && queue.size() < count; ++side) {
        const std::uint32_t other = adjacency.neighbour(queue[next], side);
        if (other == geometry::Adjacency::none || taken[other]) continue;
        taken[other] = true, queue.push_back(other);
      }
  }
  return taken;
}

void drop_unused_vertices(Mesh3f& mesh) {
  std::vector<std::uint32_t> renamed(mesh.vertices.size());
  for (const Face& f : mesh.faces)
    for (const std::uint32_t v : f) renamed[v] = 1;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < renamed.size(); ++v) {
    if (renamed[v] == 0) continue;
    mesh.vertices[kept] = mesh.vertices[v];
    renamed[v] = kept++;
  }
  mesh.vertices.resize(kept);
  for (Face& f : mesh.faces)
    for (std::uint32_t& v : f) v = renamed[v];
}

void take_out(Mesh3f& mesh, const std::vector<bool>& gone) {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (!gone[f]) mesh.faces[kept++] = mesh.faces[f];
  mesh.faces.resize(kept);
  drop_unused_vertices(mesh);
}

void unweld(Mesh3f& mesh) {
  Mesh3f soup;
  for (const Face& f : mesh.faces) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : f) soup.vertices.push_back(mesh.vertices[v]);
    soup.faces.push_back({first, first + 1, first + 2});
  }
  mesh = std::move(soup);
}

/// The corner a of face a b c becomes m, at the same place; a b m and a m c keep the edges of a paired.
void open_slit(Mesh3f& mesh, std::size_t face) {
  const auto [a, b, c] = mesh.faces[face];
  const auto m = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto place = mesh.vertices[a];
  mesh.vertices.push_back(place);
  mesh.faces[face] = {m, b, c};
  mesh.faces.push_back({a, b, m});
  mesh.faces.push_back({a, m, c});
}

void add_inner_copy(Mesh3f& mesh) {
  const auto centre = mesh.box().centre();
  const std::size_t vertices = mesh.vertices.size(), faces = mesh.faces.size();
  for (std::size_t i = 0; i < vertices; ++i) {
    const auto p = mesh.vertices[i];
    mesh.vertices.push_back((p + centre) * 0.5f);
  }
  for (std::size_t i = 0; i < faces; ++i) {
    Face f = mesh.faces[i];
    for (std::uint32_t& v : f) v += static_cast<std::uint32_t>(vertices);
    mesh.faces.push_back(f);
  }
}

}  // namespace

Damage damage_named(std::string_view name) {
  for (const auto& [known, kind] : names) {
    if (!name.starts_with(known)) continue;
    std::string_view rest = name.substr(known.size());
    if (rest.empty() && !takes_fraction(kind)) return {kind};
    if (!takes_fraction(kind) || !rest.starts_with('_')) continue;
    rest.remove_prefix(1);
    double percent = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), percent);
    if (error == std::errc() && end == rest.data() + rest.size() && percent > 0 && percent <= 100)
      return {kind, percent / 100};
  }
  throw std::invalid_argument(
      "no damage is called '" + std::string(name) +
      "'; known: hole_P, missing_P, flipped_P, duplicated_P, degenerate_P for P per cent of the "
      "faces (0 < P <= 100), unwelded, inside_out, nested");
}

Mesh3f damaged(const Mesh3f& mesh, const Damage& damage, std::uint64_t seed) {
  const std::size_t n = mesh.size();
  if (n == 0) throw std::invalid_argument("a mesh without faces cannot be damaged");
  if (takes_fraction(damage.kind) && !(damage.fraction > 0 && damage.fraction <= 1))
    throw std::invalid_argument("fraction is " + std::to_string(damage.fraction) + "; it must be in (0, 1]");
  const auto wanted = [&](double share) {
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::llround(share * static_cast<double>(n))), 1,
                                   n);
  };
  Mesh3f r = mesh;
  switch (damage.kind) {
    case DamageKind::hole:
      take_out(r, neighbourhood(mesh, wanted(damage.fraction), seed));
      break;
    case DamageKind::missing:
      take_out(r, chosen(n, wanted(damage.fraction), seed));
      break;
    case DamageKind::unwelded:
      unweld(r);
      break;
    case DamageKind::inside_out:
      for (Face& f : r.faces) std::swap(f[1], f[2]);
      break;
    case DamageKind::nested:
      add_inner_copy(r);
      break;
    default: {
      // Each slit puts two faces in.
      const bool slits = damage.kind == DamageKind::degenerate;
      const std::vector<bool> hit = chosen(n, wanted(slits ? damage.fraction / 2 : damage.fraction), seed);
      for (std::size_t f = 0; f < n; ++f) {
        if (!hit[f]) continue;
        const Face copy = r.faces[f];
        if (damage.kind == DamageKind::flipped) std::swap(r.faces[f][1], r.faces[f][2]);
        if (damage.kind == DamageKind::duplicated) r.faces.push_back(copy);
        if (slits) open_slit(r, f);
      }
    }
  }
  return r;
}

}  // namespace treeline::datasets
