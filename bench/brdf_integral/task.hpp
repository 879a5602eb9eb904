// The task brdf_integral: how much of the light from all around does a surface reflect to a viewer?
//
// A dataset is a surface (datasets_gen/surfaces). With less than 10000 elements, whatever their number, its
// integrals are asked, one query each:
//   albedo: under a sky of 1, seen at cosines from 0 to 1 and all around the normal.
//   cosine_sky: under a sky as bright as the cosine of the angle to the normal.
//   small_light: a disc of 10 degrees across, 45 degrees up, seen from about the mirror's side.
//   average: under a sky of 1, over all viewers, weighed by their cosine.
// Of stochastic methods each viewer's integral is asked 16 times, with a seed each. With 10000 elements or
// more, so many pairs of directions are asked at once:
//   evaluate: the BRDF of pairs, half of them where the surface gleams. sample: directions for 32 viewers,
//   and their weight. Of coloured surfaces in green.
// Three blocks have no surface:
//   furnace: how much a rough metal reflects, over all viewers, with all bounces between its facets; white_…
//   of facets that reflect all, colour_… of such that reflect a share (Schlick).
//   fresnel: how much a smooth boundary reflects, by medium, at angles from 0 to 90 degrees.
//   solid_angles: how large shapes are seen, by kind and by distance in radii; hemisphere is a disc that
//   touches the viewer, all_around a box around.
// Truth: of integrals two quadratures (surface_truth.hpp), whose difference is the floor; of the furnace 1,
// or walks between facets (bounce_walk.hpp), with three standard errors for the floor; else formulas in
// double and a second one for the floor. Errors: judge.hpp. Fields of its own (brdf_integral_…): truth,
// truth_max, answer_max, beyond_10 … 80 (share of the light reflected from normal incidence that leaves so
// many degrees off the mirror's direction), linearity, z, kurtosis, largest_share, negative, reciprocity,
// rotation, answer. Claims: stochastic: no bias: less than five standard errors, where at least 200 samples
// count. exact, bounded: Method::allowed. approximate: nothing.
#pragma once

#include "bench/brdf_integral/method.hpp"
#include "bench/core/registered_task.hpp"

namespace treeline::bench::brdf_integral {

class BrdfIntegralTask final : public RegisteredTask<Method> {
 public:
  BrdfIntegralTask();
  std::string name() const override { return "brdf_integral"; }
  int version() const override { return 1; }
  std::vector<BlockSpec> blocks(Profile) const override;
  /// Those of datasets_gen/hard/hard_surfaces.hpp.
  std::vector<BlockSpec> hard_blocks() const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::surface; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"albedo", "small_light"}; }
};

}  // namespace treeline::bench::brdf_integral
