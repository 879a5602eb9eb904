// A dataset: named geometry with the recipe and seed, or the file, that it came from, and a hash of its
// content.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/cloud.hpp"
#include "geometry/mesh.hpp"
#include "shading/image.hpp"
#include "shading/material.hpp"
#include "shading/scene.hpp"

namespace treeline::datasets {

enum class Kind { cloud, mesh, vectors, scene, image, room, surface };

/// Points of any dimension: row after row.
struct Vectors {
  std::size_t columns = 0;
  std::vector<float> scalars;

  std::size_t size() const { return columns == 0 ? 0 : scalars.size() / columns; }
  std::span<const float> row(std::size_t i) const { return {scalars.data() + i * columns, columns}; }
};

struct Dataset {
  std::string name;  // of the recipe, or the file's name without its folder
  Kind kind = Kind::cloud;
  std::uint64_t seed = 0;
  geometry::Cloud3f cloud;  // kind cloud
  /// Kind cloud: the same points as they are, where float rounds them by more than tolerable; else empty.
  geometry::Cloud3d precise;
  double rounding = 0;         // the farthest that float moved a coordinate, in its own unit
  geometry::Mesh3f mesh;       // kind mesh
  Vectors vectors;             // kind vectors
  shading::Scene scene;        // kind scene; its mesh is here, not in `mesh`
  shading::Image image;        // kind image
  shading::LitScene room;      // kind room; its mesh is here, not in `mesh`
  shading::Material material;  // kind surface
  bool closed = false;  // mesh: closed and consistently oriented, as the recipe promises or adjacency finds
  std::vector<std::string> notes;  // what a user should know, e.g. coordinates that float could not hold

  /// Sets `precise`, and from it `cloud` and `rounding`.
  void keep_precise(geometry::Cloud3d points);
  /// Points of a cloud, faces of a mesh, scene or room, rows of vectors, pixels of an image; 1 for a surface.
  std::size_t size() const;
  /// 64-bit hash of the content alone (coordinates or values bit by bit, and indices; of a scene also what
  /// its light and camera are, of a room its materials and camera; of a surface its material): equal content,
  /// equal hash.
  std::uint64_t hash() const;
};

/// Told as work goes on: a share in [0, 1]. Called only when generation takes more than two seconds.
using Progress = std::function<void(double)>;

struct Recipe {
  std::string name;
  Kind kind;
  std::string summary;  // one line for --list
  bool closed = false;
  bool precise = false;  // a cloud whose coordinates float cannot hold: Dataset::precise
};

/// Every recipe, in the order in which they are charted.
std::span<const Recipe> recipes();

/// Recipes for single tasks, which charts of everything leave out.
std::span<const Recipe> special_recipes();

/// Also takes the scenes of scenes/scene.hpp, the rooms of rooms/room.hpp and the surfaces of
/// surfaces/surface.hpp, with their knobs.
/// Makes n rows, about n points, exactly as near to n faces as the recipe allows (1e3 ≤ n ≤ 1e7), or the
/// square image of about n pixels (1e3 ≤ n ≤ 2^26); the same name, n and seed give the same bits on every
/// machine and with any number of threads. Of vectors, the first rows do not depend on n. A mesh may be
/// damaged, by one kind after the other of meshes/damage.hpp: "icosphere+hole_2", "icosphere+unwelded"; n is
/// then that of the whole mesh, and `closed` is found from what is left. Throws std::invalid_argument for an
/// unknown name (listing those known) or n out of range.
Dataset generate(std::string_view name, std::size_t n, std::uint64_t seed, const Progress& progress = {});

}  // namespace treeline::datasets
