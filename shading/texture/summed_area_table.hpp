// The summed-area table as a type: one for each way to keep the sums (sat_*.hpp).
#pragma once

#include "shading/texture/summed_area.hpp"
#include "shading/texture/texture_source.hpp"

namespace treeline::shading::texture {

/// Sums: Entry; sum(image, table, threads) fills the table, or throws InvalidTexture; value(mean, channel) is
/// what a mean of entries stands for.
template <class Sums>
class SummedAreaTable {
 public:
  using Entry = typename Sums::Entry;

  /// Throws InvalidTexture for a texture that has no sums here: see check_shape, and the kind of the sums.
  explicit SummedAreaTable(const Image& image, int threads = 1) { rebuild(image, threads); }

  /// As built anew; keeps the memory where the sides are those of before. If it throws the table is of no
  /// use.
  void rebuild(const Image& image, int threads = 1) {
    check_shape(image);
    sums_.sum(image, table_, threads);
  }

  int width() const { return table_.view().width; }
  int height() const { return table_.view().height; }
  int channels() const { return table_.view().channels; }
  std::size_t bytes() const { return table_.bytes(); }
  const TableView<Entry>& table() const { return table_.view(); }
  const Sums& sums() const { return sums_; }

  /// Exact but for the entries where the footprint is a box along the axes; else that of fitted_box.
  void mean(const Footprint& footprint, float* out) const { box_mean(fitted_box(footprint), out); }
  /// In double for those who go on to subtract: variances from means and means of squares.
  template <std::floating_point Out>
  void box_mean(const Box& box, Out* out) const {
    with_channels(channels(), [&](auto count) {
      constexpr int channels = count;
      double found[channels];
      box_means<channels>(table_.view(), box, found);
      for (int c = 0; c < channels; ++c) out[c] = static_cast<Out>(sums_.value(found[c], c));
    });
  }

 private:
  Sums sums_;
  Table<Entry> table_;
};

/// Throws InvalidTexture if a sum over all is no number: then a texel is none, or the sums are too large.
template <class Entry>
void check_sums(const Image& image, const TableView<Entry>& table) {
  for (int c = 0; c < table.channels; ++c)
    if (!std::isfinite(table.at(table.width, table.height)[c])) {
      check_finite(image);
      throw InvalidTexture("the sums of the texture are beyond the range of their type");
    }
}

/// As they are, in floating point.
template <std::floating_point T>
struct PlainSums {
  using Entry = T;

  void sum(const Image& image, Table<Entry>& table, int threads) {
    sum_up(PlainSource<Entry>(image), image, table, threads);
    check_sums(image, table.view());
  }
  double value(double mean, int) const { return mean; }
};

/// As levels, in integers: the whole range [0, 1] if all values are in it, else their own range.
template <class Table>
Levels sum_levels(const Image& image, Table& table, int threads) {
  std::atomic<bool> outside{false};
  using Entry = std::remove_cvref_t<decltype(*table.view().origin)>;
  Levels levels;
  sum_up(LevelSource<Entry>(image, levels, outside), image, table, threads);
  if (!outside) return levels;
  check_finite(image);
  levels = Levels::over(image);
  sum_up(LevelSource<Entry>(image, levels, outside), image, table, threads);
  return levels;
}

}  // namespace treeline::shading::texture
