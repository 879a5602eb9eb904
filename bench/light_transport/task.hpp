// The task light_transport: what radiance does each pixel of a camera see in a room?
//
// The build makes the tree over the room's faces; a query is one pixel, with all its samples. Query sets:
//   image: the pixels of the room's camera.
//   walls, of closed_box: 512 pixels a wall whose rays end anywhere on it, as the mean radiance of each wall
//     is known without a ray (box_radiosity.hpp), for any number of bounces.
// Truth: formulas where there are some (known.hpp), else a converged image in two halves (truth.hpp).
// Errors: error is the root of relMSE (judge.hpp), mean the mean absolute error and bias the signed one, both
// over the mean radiance. Errors of a single pixel are no limit of the advice: fireflies are rare.
// Fields of its own (light_transport_…): rel_mse; max and p99 of the pixels' relative errors; z (of the mean
// difference from the truth, in standard errors, from the pixels' own spread; of walls the worst) and
// z_tested, whether that says something, which z_skew decides; bias_error (standard error of the bias, from
// the samples' spread in each pixel); told_error (the film's own estimate of its relative error); kurtosis
// (of a pixel's samples, in the mean) and largest_share (of the image's light, of one sample); rays and
// shadow_rays a path; of Whitted tracing bounce_1, bounce_2, … (rays that leave what primary rays meet, and
// so on, a primary ray), shadow_1, … and all_rays; of walls floor_bias, floor_error (its standard error) and
// floor_exact (what leaving out further bounces does by radiosity); truth_samples. Claims: stochastic:
// unbiased, unless the knob bounces ends paths early, and of walls then as bright as radiosity says of so
// many: a z beyond judge.hpp's bound is wrong, where enough samples make z normal. approximate: nothing but
// finite numbers. The seed draws rooms, truths and paths anew.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/light_transport/block.hpp"

namespace treeline::bench::light_transport {

class LightTransportTask final : public RegisteredTask<Method> {
 public:
  LightTransportTask();
  std::string name() const override { return "light_transport"; }
  int version() const override { return 1; }
  std::vector<BlockSpec> blocks(Profile) const override;
  /// Those of datasets_gen/hard/hard_light.hpp.
  std::vector<BlockSpec> hard_blocks() const override;
  std::vector<BlockSpec> scaling_blocks(Profile) const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::room; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"image"}; }
  void pictures(const BlockSpec&, const RunContext&, const std::string& folder) const override;

 private:
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&, bool scaling) const;
};

}  // namespace treeline::bench::light_transport
