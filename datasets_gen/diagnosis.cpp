#include "datasets_gen/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "geometry/crossing_point.hpp"

namespace treeline::datasets {
namespace {

using geometry::Finding;
using geometry::MeshCheck;

struct Named {
  const char *key, *text;
  const Finding& finding;
};

std::array<Named, 12> findings_of(const MeshCheck& m) {
  return {{{"non_finite_vertices", "vertices that are not finite", m.non_finite_vertices},
           {"unused_vertices", "vertices without a face", m.unused_vertices},
           {"duplicate_vertices", "vertices at the position of an earlier one", m.duplicate_vertices},
           {"repeated_corner_faces", "faces that name a vertex twice", m.repeated_corner_faces},
           {"degenerate_faces", "faces without area", m.degenerate_faces},
           {"duplicate_faces", "faces that are there already", m.duplicate_faces},
           {"boundary_edges", "edges with one face", m.boundary_edges},
           {"non_manifold_edges", "edges with more than two faces", m.non_manifold_edges},
           {"misoriented_edges", "edges whose faces look to different sides", m.misoriented_edges},
           {"non_manifold_vertices", "vertices where several fans of faces touch", m.non_manifold_vertices},
           {"crossed_edges", "edges along which the surface crosses itself", m.crossed_edges},
           {"misnested_components", "closed parts that look the wrong way for where they lie",
            m.misnested_components}}};
}

/// The crossings as a finding like the others.
Finding crossings_of(const geometry::Mesh3f& mesh, const accel::SelfIntersections& crossings) {
  Finding r;
  r.count = crossings.count;
  for (const auto& pair : crossings.pairs)
    r.first.push_back(
        {{pair[0], pair[1]}, {}, geometry::crossing_point(mesh.triangle(pair[0]), mesh.triangle(pair[1]))});
  return r;
}

template <class T>
std::string coordinates(const geometry::Vec<T, 3>& p) {
  return fmt::format("({:.9g} {:.9g} {:.9g})", p[0], p[1], p[2]);
}

std::string line_of(const geometry::Mesh3f& mesh, const Finding::Example& example) {
  constexpr std::size_t most_faces = 4;  // an edge may have any number of them
  std::string r;
  for (const std::uint32_t f : std::span(example.faces).first(std::min(most_faces, example.faces.size())))
    r += fmt::format("{}{}", r.empty() ? "face " : ", face ", f);
  if (example.faces.size() > most_faces)
    r += fmt::format(" and {} more faces", example.faces.size() - most_faces);
  for (const std::uint32_t v : example.vertices)
    r += fmt::format("{}vertex {} {}", r.empty() ? "" : ", ", v, coordinates(mesh.vertices[v]));
  if (example.at)
    r += fmt::format(" meet at {}", coordinates(*example.at));
  else if (example.vertices.empty() && !example.faces.empty())
    r += fmt::format(" with a corner at {}", coordinates(mesh.vertices[mesh.faces[example.faces[0]][0]]));
  return r;
}

void add_lines(std::string& out, const geometry::Mesh3f& mesh, const char* text, const Finding& finding) {
  out += fmt::format("{:>10}  {}\n", finding.count, text);
  for (const auto& example : finding.first) out += fmt::format("{:14}{}\n", "", line_of(mesh, example));
  if (finding.count > finding.first.size() && !finding.first.empty()) out += fmt::format("{:14}…\n", "");
}

const char* yes_or_no(bool x) { return x ? "yes" : "no"; }
/// Why not, too: edges with three faces leave a mesh as open as those with one.
std::string closed_or_not(bool closed, std::size_t odd_edges) {
  return closed ? "closed: yes" : fmt::format("closed: no, {} edges have an odd number of faces", odd_edges);
}

// ---- JSON -----------------------------------------------------------------------------------------------

std::string quoted(std::string_view text) {
  std::string r = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      (r += '\\') += c;
    else if (static_cast<unsigned char>(c) < 32)
      r += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      r += c;
  }
  return r + "\"";
}
std::string number_or_null(double x) { return std::isfinite(x) ? fmt::format("{}", x) : "null"; }

std::string json_of(const geometry::Mesh3f& mesh, const Finding& finding) {
  std::string examples;
  for (const auto& e : finding.first) {
    std::string places = e.at ? fmt::format("[{},{},{}]", (*e.at)[0], (*e.at)[1], (*e.at)[2]) : "";
    for (const std::uint32_t v : e.vertices) {
      const auto& p = mesh.vertices[v];
      places += fmt::format("{}[{},{},{}]", places.empty() ? "" : ",", number_or_null(double(p[0])),
                            number_or_null(double(p[1])), number_or_null(double(p[2])));
    }
    examples +=
        fmt::format(R"({}{{"faces":[{}],"vertices":[{}],"positions":[{}]}})", examples.empty() ? "" : ",",
                    fmt::join(e.faces, ","), fmt::join(e.vertices, ","), places);
  }
  return fmt::format(R"({{"count":{},"first":[{}]}})", finding.count, examples);
}

}  // namespace

bool Diagnosis::clean() const {
  for (const Named& n : findings_of(mesh))
    if (n.finding.count > 0) return false;
  return crossings.count == 0 && mesh.closed && mesh.oriented && mesh.volume > 0;
}

Diagnosis diagnose(const geometry::Mesh3f& mesh, std::size_t examples, int threads) {
  Diagnosis r;
  r.mesh = geometry::check_mesh(mesh, examples);
  r.crossings = accel::self_intersections(mesh, r.mesh.sound_faces, {.kept = examples, .threads = threads});
  if (has_half_edges()) r.half_edges = half_edge_report(mesh);
  return r;
}

std::string as_text(const Dataset& dataset, const Diagnosis& d) {
  const MeshCheck& m = d.mesh;
  std::string out =
      fmt::format("{}: {} triangles, {} vertices, {} edges\n", dataset.name, m.faces, m.vertices, m.edges);
  for (const std::string& note : dataset.notes) out += fmt::format("  read with a note: {}\n", note);
  out += fmt::format("  {}; consistently oriented: {}; ", closed_or_not(m.closed, m.odd_edges),
                     yes_or_no(m.oriented));
  if (m.closed && m.oriented && !std::isfinite(m.volume))
    out += "no volume, as a vertex is not finite\n";
  else if (m.closed && m.oriented)
    out += fmt::format("signed volume {:.9g}: faces look {}\n", m.volume,
                       m.volume > 0   ? "outward"
                       : m.volume < 0 ? "inward"
                                      : "nowhere");
  else
    out += "no volume\n";
  out += fmt::format("  {} {} by edges", m.components, m.components == 1 ? "component" : "components");
  if (m.closed && m.oriented) out += fmt::format(", {} of them facing inward", m.inward_components);
  out += fmt::format("; {} boundary loops\n", m.boundary_loops);
  bool listed = !d.crossings.pairs.empty();
  for (const Named& n : findings_of(m)) {
    add_lines(out, dataset.mesh, n.text, n.finding);
    listed = listed || !n.finding.first.empty();
  }
  add_lines(out, dataset.mesh, "pairs of faces that cross or overlap (copies of a face left out)",
            crossings_of(dataset.mesh, d.crossings));
  if (listed) out += "  numbers count from 0; faces are triangles, as polygons of the file were cut\n";
  if (m.duplicate_vertices.count > 0)
    out += fmt::format(
        "  with vertices at equal positions joined: {} vertices; {}; consistently oriented: {}; {} edges "
        "with "
        "one face, {} with more than two\n",
        m.welded.vertices, closed_or_not(m.welded.closed, m.welded.odd_edges), yes_or_no(m.welded.oriented),
        m.welded.boundary_edges, m.welded.non_manifold_edges);
  if (d.half_edges && !d.half_edges->faithful())
    out += fmt::format(
        "  OpenMesh's half-edges cannot hold this: it would copy {} vertices and leave out {} faces, and "
        "then have {} boundary edges\n",
        d.half_edges->copied_vertices, d.half_edges->lost_faces, d.half_edges->boundary_edges);
  if (d.clean()) return out + "  clean\n";
  const bool inverted = m.closed && m.oriented && m.volume < 0;
  return out + (inverted ? "  not clean: the faces look inward\n" : "  not clean\n");
}

std::string as_json(const Dataset& dataset, const Diagnosis& d) {
  const MeshCheck& m = d.mesh;
  std::string out = fmt::format(
      R"({{"file":{},"faces":{},"vertices":{},"edges":{},"closed":{},"oriented":{},"volume":{},"components":{},)"
      R"("inward_components":{},"odd_edges":{},"boundary_loops":{},"clean":{})",
      quoted(dataset.name), m.faces, m.vertices, m.edges, m.closed, m.oriented,
      m.closed && m.oriented ? number_or_null(m.volume) : "null", m.components, m.inward_components,
      m.odd_edges, m.boundary_loops, d.clean());
  for (const Named& n : findings_of(m))
    out += fmt::format(R"(,"{}":{})", n.key, json_of(dataset.mesh, n.finding));
  out += fmt::format(R"(,"self_intersections":{})",
                     json_of(dataset.mesh, crossings_of(dataset.mesh, d.crossings)));
  out +=
      fmt::format(R"(,"welded":{{"vertices":{},"closed":{},"oriented":{},"odd_edges":{},"boundary_edges":{},)"
                  R"("non_manifold_edges":{}}})",
                  m.welded.vertices, m.welded.closed, m.welded.oriented, m.welded.odd_edges,
                  m.welded.boundary_edges, m.welded.non_manifold_edges);
  if (d.half_edges)
    out += fmt::format(R"(,"openmesh":{{"copied_vertices":{},"lost_faces":{},"boundary_edges":{}}})",
                       d.half_edges->copied_vertices, d.half_edges->lost_faces, d.half_edges->boundary_edges);
  return out + "}\n";
}

}  // namespace treeline::datasets
