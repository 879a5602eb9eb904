// What theory says that a method is off by in a scene made for it: one field of the row, as a number.
//
// Rows carry both (shadow_figure names the field, shadow_figure_value is what it should be,
// shadow_figure_bias the bias, shadow_figure_slack how far off it may be), tests hold them against each
// other. Derivations stand at each figure in figures.cpp.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "bench/core/row.hpp"
#include "bench/shadow/method.hpp"
#include "shading/scene.hpp"

namespace treeline::bench::shadow {

struct Figure {
  std::string field;
  double value;
  std::optional<double> bias{};  ///< that the method had, in lengths of the scene along the light
  /// What receivers that are finitely many, texels and rounding may leave of it; by derivation.
  double slack = 0;
};

std::optional<Figure> figure_of(const shading::Scene&, const std::string& query_set,
                                std::span<const Receiver>, const std::string& method,
                                const Knobs& build_knobs, const Knobs& query_knobs);

}  // namespace treeline::bench::shadow
