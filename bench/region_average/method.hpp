// What a method gives this task: something made from a texture that answers whole batches of footprints.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "bench/core/task.hpp"
#include "shading/image.hpp"
#include "shading/texture/footprint.hpp"

namespace treeline::bench::region_average {

using shading::Image;
using shading::texture::Footprint;

/// What a promise may depend on.
struct TextureFacts {
  bool levels = false;      ///< every value is one of 65536 levels from 0 to 1
  bool unit = false;        ///< every value is from 0 to 1
  double range = 0;         ///< largest value less the smallest
  double absolute_sum = 0;  ///< of all values of the channel that has most
  double largest = 0;       ///< absolute value
  double rows_and_columns = 0;
};

class Averager {
 public:
  virtual ~Averager() = default;
  /// The means of footprint i go to out[i * channels] and on.
  virtual void means(std::span<const Footprint>, const Knobs& query_knobs, int threads,
                     std::span<float> out) const = 0;
  /// Builds it anew from the same texture, in its own memory where it can.
  virtual void rebuild(const Image&, int threads) = 0;
  /// As fields of the row: region_average_…
  virtual Knobs facts() const { return Knobs::object(); }
};

struct Input {
  const Image& image;
  int threads = 1;
};

struct Method {
  MethodInfo info;
  std::function<std::unique_ptr<Averager>(const Input&, const Knobs& build_knobs)> build;
  /// For boxes along the axes alone it promises anything.
  bool boxes_only = false;
  /// How far a mean may be off beside the last digit of float, by the method's own claim (exact or bounded):
  /// `entries`: the sum of the weights that a box has for sums of whole texels.
  std::function<double(const TextureFacts&, double entries)> allowed = {};
};

}  // namespace treeline::bench::region_average
