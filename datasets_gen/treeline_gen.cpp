// treeline_gen RECIPE --n N --seed S FILE: makes one dataset and writes it as PLY, OBJ, PCD or XYZ.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "datasets_gen/dataset.hpp"
#include "datasets_gen/files/write.hpp"

namespace {

using namespace treeline::datasets;

const char* kind_name(Kind kind) {
  return kind == Kind::cloud ? "cloud" : kind == Kind::mesh ? "mesh" : "vectors";
}

void list() {
  for (const Recipe& r : recipes()) fmt::print("{:<17} {:<7} {}\n", r.name, kind_name(r.kind), r.summary);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Makes a dataset from a recipe and a seed, and writes it to a file (.ply, .obj, .pcd, .xyz).");
  std::string recipe, file;
  double n = 100'000;
  std::uint64_t seed = 1;
  bool list_only = false, force = false;
  app.add_option("recipe", recipe, "which one; see --list");
  app.add_option("file", file, "where to; the extension tells the format");
  app.add_option("--n", n, "points of a cloud or triangles of a mesh, 1e3 to 1e7")->capture_default_str();
  app.add_option("--seed", seed, "the same seed gives the same bits on every machine")
      ->capture_default_str()
      ->check([](const std::string& text) {  // which would wrap
        return std::string(text.find('-') != std::string::npos ? "must not be negative" : "");
      });
  app.add_flag("--list", list_only, "list the recipes");
  app.add_flag("--force", force, "replace an existing file");
  try {
    app.parse(argc, argv);
    if (!list_only && (recipe.empty() || file.empty()))
      throw CLI::ValidationError("RECIPE and FILE are needed; --list shows the recipes");
    if (!list_only && (!(n >= 0) || n > 1e18 || n != static_cast<double>(static_cast<std::size_t>(n))))
      throw CLI::ValidationError("--n must be a whole number");
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  if (list_only) return list(), 0;

  try {
    if (!force && std::filesystem::exists(file))
      throw FileError(file, "", "exists already; --force replaces it");
    bool shown = false;
    const Dataset made = generate(recipe, static_cast<std::size_t>(n), seed, [&](double share) {
      fmt::print(stderr, "\r{}: {:3.0f} %", recipe, 100 * share);
      shown = true;
    });
    if (shown) fmt::print(stderr, "\n");
    write(made, file, force);
    fmt::print("{}: {} {}, hash {:016x}\n", file, made.size(),
               made.kind == Kind::cloud ? "points" : "triangles", made.hash());
  } catch (const std::exception& e) {
    fmt::print(stderr, "treeline_gen: {}\n", e.what());
    return 2;
  }
  return 0;
}
