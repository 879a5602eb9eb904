// The task shadow: how much of the light does each point see that the camera sees?
//
// Receivers (receivers.hpp) are what pixels show of the scene, with the light wholly above their surface. The
// build makes what a method keeps of light and scene (maps, fields, trees); a query is one receiver.
// Query sets:
//   image: all receivers, in the order of pixels.
//   edge, where the scene has a straight edge: 2001 receivers across its penumbra.
//   contact, where a blocker stands on the floor: receivers from its foot into its shadow.
//   leak, where blockers lie one above the other: receivers in the shadow of all.
//   motion: those of edge, while the light moves a tenth of a texel of a map of 1024 a frame (block.hpp).
//     Each frame's build is that of the row, and not timed here.
// Truth: closed forms where there are some (closed_form.hpp), else rays (truth.hpp), with what two halves of
// them differ by as the floor. A share of the light is one of its area, not weighted by the cosine.
// Errors: error is the root of the mean square of the share's error over the set, mean that of the absolute,
// bias the signed mean (positive: too light). Errors of a single receiver are no limit of the advice: at a
// hard shadow's border every map is off by 1 somewhere. Of motion the error is that of the change between
// frames.
// Fields of its own (shadow_…): judge.hpp; truth_samples (rays a receiver); of image split and split_ggx_<α>
// (split.hpp); of lines answered (the mean) and levels (different answers); of edge width, width_true and
// width_error (10 to 90 % of the light, in lengths of the scene, and relative); of contact gap and gap_texels
// (how far from the foot it is lit); of motion crawl_peak; figure and figure_value (figures.hpp: what theory
// says one of these is).
// Claims: of all methods, a share is one. exact, bounded: of a hard light, off by more than 0.1 only within
// 1e-4 of the scene's diagonal from where the truth changes. approximate, stochastic: nothing more.
#pragma once

#include "bench/core/registered_task.hpp"
#include "bench/shadow/block.hpp"

namespace treeline::bench::shadow {

class ShadowTask final : public RegisteredTask<Method> {
 public:
  ShadowTask();
  std::string name() const override { return "shadow"; }
  int version() const override { return 1; }
  std::vector<BlockSpec> blocks(Profile) const override;
  std::vector<BlockSpec> hard_blocks() const override;
  std::vector<TaskFlag> flags() const override;
  void check_flags(const RunContext&) const override;
  datasets::Kind dataset_kind() const override { return datasets::Kind::scene; }
  std::unique_ptr<Block> open(const BlockSpec&, const RunContext&) const override;
  std::unique_ptr<Block> open(datasets::Dataset, const RunContext&) const override;
  std::vector<std::string> advise_on() const override { return {"image"}; }
  void pictures(const BlockSpec&, const RunContext&, const std::string& folder) const override;
};

}  // namespace treeline::bench::shadow
