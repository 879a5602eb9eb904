// Damage done to a mesh, of the kinds that files have: what inside tests, distances and repairs must stand or
// refuse. Any base mesh, any fraction, a seed.
//
//   hole          one hole of neighbouring faces
//   missing       single faces taken out here and there
//   flipped       faces turned around
//   duplicated    faces there twice, the copies at the end
//   degenerate    faces without area put in, so that a closed mesh stays closed and manifold: at one corner
//   of a face
//                 the vertex is doubled in place, and two faces fill the slit
//   unwelded      every face with corners of its own
//   inside_out    all faces turned around
//   nested        a second copy of half the size inside, facing the same way; inside it the surface winds
//   around
//                 twice. For meshes that are star-shaped about the centre of their box; others may cross
//                 their copies
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "geometry/mesh.hpp"

namespace treeline::datasets {

enum class DamageKind { hole, missing, flipped, duplicated, degenerate, unwelded, inside_out, nested };

struct Damage {
  DamageKind kind;
  double fraction = 0;  ///< of the faces, of the first five kinds; in (0, 1]
};

/// From its name, with the fraction in per cent: "flipped_10", "hole_0.5", "unwelded". Throws
/// std::invalid_argument, listing those known.
Damage damage_named(std::string_view name);

/// The same mesh, damage and seed give the same bits on every machine. Faces left alone keep their order. At
/// least one face is hit by any fraction. Throws std::invalid_argument for a fraction out of range and a mesh
/// without faces.
geometry::Mesh3f damaged(const geometry::Mesh3f& mesh, const Damage& damage, std::uint64_t seed);

}  // namespace treeline::datasets
