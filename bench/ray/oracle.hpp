// The second witness: every triangle tried in CGAL's exact kernel, in which nothing rounds. For small sets.
// Same conventions as truth.hpp. Nothing in builds without CGAL.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bench/ray/truth.hpp"

namespace treeline::bench::ray {

std::optional<std::vector<TrueHit>> oracle_closest(const geometry::Mesh3f& mesh,
                                                   std::span<const geometry::Rayf> rays);

}  // namespace treeline::bench::ray
