// treeline_gen RECIPE FILE: makes one dataset and writes it as PLY, OBJ, PCD, XYZ or CSV, an image as PNG or
// EXR. treeline_gen --check FILE: what is wrong with a mesh. treeline_gen --decimate RATIO IN OUT: a mesh of
// fewer faces, and what that lost. Exit status: 0 done, and nothing found; 1 the check found something; 2
// unusable arguments or files.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <thread>

#include "datasets_gen/dataset.hpp"
#include "datasets_gen/diagnosis.hpp"
#include "datasets_gen/files/write.hpp"
#include "datasets_gen/loss.hpp"
#include "datasets_gen/scenes/light.hpp"
#include "datasets_gen/scenes/scene.hpp"
#include "datasets_gen/whole_number.hpp"
#include "geometry/weld.hpp"

namespace {

using namespace treeline::datasets;
namespace geometry = treeline::geometry;

struct Arguments {
  std::string recipe, file;  // or the file that is read, and the one written
  double n = 100'000;
  std::uint64_t seed = 1;
  bool list = false, force = false, check = false, json = false, weld = false;
  double ratio = 0;  // of --decimate
  std::size_t examples = 5;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
};

const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::cloud:
      return "cloud";
    case Kind::mesh:
      return "mesh";
    case Kind::vectors:
      return "vectors";
    case Kind::scene:
      return "scene";
    case Kind::image:
      return "image";
    case Kind::room:
      return "room";
    case Kind::surface:
      return "surface";
  }
  return "";
}

void list() {
  for (const auto all : {recipes(), special_recipes()})
    for (const Recipe& r : all) fmt::print("{:<17} {:<7} {}\n", r.name, kind_name(r.kind), r.summary);
  for (const Kind kind : {Kind::scene, Kind::room, Kind::surface})
    for (const KnobRecipe& r : knob_recipes(kind))
      fmt::print("{:<17} {:<7} {}{}\n", r.name, kind_name(kind), r.summary,
                 r.knobs.empty() ? "" : "; " + with_defaults(r) + ", numbers alone");
  fmt::print(
      "Of scenes the mesh is written, and light and camera are printed; of rooms the mesh; surfaces have "
      "none.\n");
  fmt::print(
      "Meshes can be damaged: NAME+hole_P, +missing_P, +flipped_P, +duplicated_P, +degenerate_P (P per cent "
      "of the\n"
      "faces), +unwelded, +inside_out, +nested; several, too: icosphere+hole_2+flipped_10\n");
}

void refuse_existing(const Arguments& a) {
  if (!a.force && std::filesystem::exists(a.file))
    throw FileError(a.file, "", "exists already; --force replaces it");
}

Dataset read_mesh(const std::string& file) {
  Dataset d = read(file);
  if (d.kind != Kind::mesh)
    throw FileError(file, "",
                    d.kind == Kind::image ? "is an image, not a mesh" : "holds points and no faces");
  return d;
}

void make(const Arguments& a) {
  refuse_existing(a);
  bool shown = false;
  const Dataset made = generate(a.recipe, static_cast<std::size_t>(a.n), a.seed, [&](double share) {
    fmt::print(stderr, "\r{}: {:3.0f} %", a.recipe, 100 * share);
    shown = true;
  });
  if (shown) fmt::print(stderr, "\n");
  write(made, a.file, a.force);
  fmt::print("{}: {} {}, hash {:016x}\n", a.file, made.size(),
             made.kind == Kind::cloud   ? "points"
             : made.kind == Kind::image ? "pixels"
                                        : "triangles",
             made.hash());
  if (made.kind != Kind::scene) return;
  const treeline::shading::Camera& c = made.scene.camera;
  fmt::print("light: {}\ncamera: at {},{},{} towards {},{},{}\n", format_light(made.scene.light),
             c.position[0], c.position[1], c.position[2], c.target[0], c.target[1], c.target[2]);
}

int check(const Arguments& a) {
  const Dataset d = read_mesh(a.recipe);
  const Diagnosis found = diagnose(d.mesh, a.examples, a.threads);
  fmt::print("{}", a.json ? as_json(d, found) : as_text(d, found));
  return found.clean() ? 0 : 1;
}

void decimate(const Arguments& a) {
  refuse_existing(a);
  Dataset d = read_mesh(a.recipe);
  if (a.weld) {
    geometry::Welded<float> welded = geometry::welded(d.mesh);
    fmt::print("{}: {} vertices joined, {} faces left out that named one twice\n", a.recipe, welded.joined,
               welded.collapsed);
    d.mesh = std::move(welded.mesh);
  }
  Decimated made = decimated(d.mesh, a.ratio);
  if (!made.input.faithful())
    fmt::print(
        stderr,
        "{}: OpenMesh's half-edges cannot hold it as it is; {} vertices were copied and {} faces left out\n",
        a.recipe, made.input.copied_vertices, made.input.lost_faces);
  // Faces of a soup share no edge that could be collapsed.
  const geometry::MeshCheck given = geometry::check_mesh(d.mesh, 0);
  if (given.welded.boundary_edges < given.boundary_edges.count)
    fmt::print(stderr,
               "{}: {} of its vertices lie at the position of an earlier one, and edges between such are not "
               "collapsed; --weld joins them first\n",
               a.recipe, given.duplicate_vertices.count);
  const Loss lost = loss(d.mesh, made.mesh, a.threads);
  const std::size_t before = d.mesh.size(), after = made.mesh.size();
  d.mesh = std::move(made.mesh);
  write(d, a.file, a.force);
  fmt::print("{}: {} of {} triangles, {:.2f} %\n{}", a.file, after, before,
             100 * static_cast<double>(after) / static_cast<double>(before), as_text(lost));
  if (static_cast<double>(after) > a.ratio * static_cast<double>(before))
    fmt::print(stderr, "{}: no further edge can be collapsed\n", a.file);
}

void check_arguments(const Arguments& a, bool decimates) {
  if (a.list) return;
  if (a.check && decimates) throw CLI::ValidationError("--check and --decimate exclude each other");
  if (a.check && (a.recipe.empty() || !a.file.empty())) throw CLI::ValidationError("--check takes one FILE");
  if (a.json && !a.check) throw CLI::ValidationError("--json belongs to --check");
  if (a.weld && !decimates) throw CLI::ValidationError("--weld belongs to --decimate");
  if (decimates && a.file.empty()) throw CLI::ValidationError("--decimate takes the files IN and OUT");
  if (!a.check && a.file.empty())
    throw CLI::ValidationError("RECIPE and FILE are needed; --list shows the recipes");
  if (!(a.n >= 0) || a.n > 1e18 || a.n != static_cast<double>(static_cast<std::size_t>(a.n)))
    throw CLI::ValidationError("--n must be a whole number");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Makes a dataset from a recipe and a seed, and writes it to a file (.ply, .obj, .pcd, .xyz, .csv; "
      ".png, .exr).");
  Arguments a;
  app.add_option("recipe", a.recipe, "which one; see --list (with --check and --decimate: the file to read)");
  app.add_option("file", a.file, "where to; the extension tells the format");
  app.add_option("--n", a.n, "points of a cloud, triangles of a mesh or pixels of an image, 1e3 to 1e7")
      ->capture_default_str();
  app.add_option("--seed", a.seed, "the same seed gives the same bits on every machine")
      ->capture_default_str()
      ->check(whole_number());
  app.add_flag("--list", a.list, "list the recipes");
  app.add_flag("--force", a.force, "replace an existing file");
  app.add_flag("--check", a.check,
               "say what is wrong with the mesh in a file; exit status 1 if anything is. Numbers of faces "
               "and vertices count from 0; faces are triangles, as polygons of the file were cut");
  app.add_flag("--json", a.json, "the check as JSON");
  app.add_option("--examples", a.examples, "how many of each finding the check lists")
      ->capture_default_str()
      ->check(whole_number());
  app.add_option("--threads", a.threads, "of the check")->check(CLI::Range(1, 1024));
  const auto* ratio =
      app.add_option("--decimate", a.ratio, "read a mesh, keep this share of its faces, write it")
          ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--weld", a.weld, "join vertices at equal positions before the decimation");
  try {
    app.parse(argc, argv);
    check_arguments(a, ratio->count() > 0);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    if (a.list) return list(), 0;
    if (a.check) return check(a);
    if (ratio->count() > 0)
      decimate(a);
    else
      make(a);
  } catch (const std::exception& e) {
    fmt::print(stderr, "treeline_gen: {}\n", e.what());
    return 2;
  }
  return 0;
}
