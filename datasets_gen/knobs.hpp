// Names with numbers after them: "tilted_plane_85_30" is the recipe tilted_plane with two knobs.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets_gen/dataset.hpp"

namespace treeline::datasets {

/// A number that may follow a recipe's name; those left out, from the last on, are the default.
struct Knob {
  std::string name;  ///< with its unit
  double value, low, high;
};

struct KnobRecipe {
  std::string name, summary;
  std::vector<Knob> knobs;
};

/// Whether the name is the recipe's, or begins with it and an underscore.
bool names(std::string_view name, const KnobRecipe& recipe);

/// The numbers after the recipe's name, or their defaults. Throws std::invalid_argument, which begins with
/// `what` ("scene") and the name, for one that is no number or out of its range, and for one too many.
std::vector<double> read_knobs(std::string_view what, std::string_view name, const KnobRecipe& recipe);

/// The recipe's name with its knobs' names and defaults: "tilted_plane_theta_deg=60_phi_deg=0".
std::string with_defaults(const KnobRecipe& recipe);

/// The recipes with knobs of a kind: scenes, rooms, surfaces; none of the other kinds.
std::span<const KnobRecipe> knob_recipes(Kind kind);

}  // namespace treeline::datasets
