// Summed-area tables: the mean over any box along the axes from sixteen entries (Crow 1984).
//
// The sum over whole texels between two columns and two rows is the sum of four entries. A box with
// fractional borders is nine such blocks, its corners, borders and middle, each with a weight: the same
// sixteen entries that bilinear corners read, and exact, as the texture is constant on each texel. What is
// not exact is the entries: sums grow with the table while blocks stay small, so that a float table loses
// about 0.4 ulp of those sums in its last quarter, over the texels of the block: a little less than so much
// for a single texel, up to four times as much for 16², as entries near each other round alike. What storage
// does about it: the files sat_*.hpp. Cost of a mean: sixteen entries a channel, two lines of cache for each
// of four rows. Known weakness: boxes along the axes alone; other footprints get the box of their variances
// (fitted_box).
#pragma once

#include "shading/texture/prefix_sums.hpp"
#include "shading/texture/texel_runs.hpp"

namespace treeline::shading::texture {

namespace summed_area {

/// Whether integers wrap: then blocks of more texels than that are summed in pieces.
template <class Entry>
inline constexpr bool wraps = std::is_same_v<Entry, std::uint32_t>;
inline constexpr std::int64_t unwrapped_texels = 65536;  // of values up to 65535

template <class Entry>
double difference(const Entry* a, const Entry* b, const Entry* c, const Entry* d, int channel) {
  if constexpr (std::is_floating_point_v<Entry>)
    return (double(d[channel]) - double(c[channel])) - (double(b[channel]) - double(a[channel]));
  else  // integers of either kind: differences of differences wrap back
    return static_cast<double>(static_cast<Entry>(d[channel] - c[channel] - (b[channel] - a[channel])));
}

/// The sum over texels [x0, x1) x [y0, y1) of a table that wraps.
template <class Entry>
double sum_in_pieces(const TableView<Entry>& table, int x0, int x1, int y0, int y1, int channel) {
  double sum = 0;
  constexpr int side = 256;
  for (int y = y0; y < y1; y += side)
    for (int x = x0; x < x1; x += side) {
      const int r = std::min(x1, x + side), b = std::min(y1, y + side);
      sum += difference(table.at(x, y), table.at(r, y), table.at(x, b), table.at(r, b), channel);
    }
  return sum;
}

template <class T>
struct Four {
  typedef T type __attribute__((vector_size(4 * sizeof(T))));
};
using Doubles = Four<double>::type;
/// What blocks are found in: integers as they are, so that they wrap back; floats as double.
template <class Entry>
using Exact = std::conditional_t<std::is_same_v<Entry, float>, double, Entry>;

/// Means over the box of runs, of what the entries sum. Four lanes: the four columns of a row, whose
/// differences are its three blocks; or four channels.
template <int channels, class Entry>
void means(const TableView<Entry>& table, const TexelRuns& across, const TexelRuns& down, double* out) {
  using Lanes = typename Four<Exact<Entry>>::type;
  const Entry* row[4];
  std::ptrdiff_t column[4];
  for (std::size_t k = 0; k < 4; ++k) {
    row[k] = table.origin + static_cast<std::ptrdiff_t>(down.edge[k]) * table.stride;
    column[k] = static_cast<std::ptrdiff_t>(across.edge[k]) * channels;
  }
  if constexpr (channels == 4) {
    const auto load = [&](Lanes& v, std::size_t j, std::size_t i) {
      typename Four<Entry>::type packed;
      std::memcpy(&packed, row[j] + column[i], sizeof packed);
      v = __builtin_convertvector(packed, Lanes);
    };
    Lanes above[4], below;
    for (std::size_t i = 0; i < 4; ++i) load(above[i], 0, i);
    Doubles sum{};
    for (std::size_t j = 0; j < 3; ++j) {
      Doubles of_row{};
      Lanes left = above[0];
      load(below, j + 1, 0);
      left = below - left, above[0] = below;
      for (std::size_t i = 0; i < 3; ++i) {
        load(below, j + 1, i + 1);
        const Lanes right = below - above[i + 1];
        above[i + 1] = below;
        of_row += across.weight[i] * __builtin_convertvector(right - left, Doubles);
        left = right;
      }
      sum += down.weight[j] * of_row;
    }
    for (int c = 0; c < 4; ++c) out[c] = sum[c];
  } else {
    const Doubles weights{across.weight[0], across.weight[1], across.weight[2], 0};
    for (int c = 0; c < channels; ++c) {
      const auto load = [&](Lanes& v, std::size_t j) {
        const Entry* at = row[j] + c;
        v = Lanes{at[column[0]], at[column[1]], at[column[2]], at[column[3]]};
      };
      Lanes above, below;
      load(above, 0);
      Doubles sum{};
      for (std::size_t j = 0; j < 3; ++j) {
        load(below, j + 1);
        const Lanes strip = below - above;
        above = below;
        const Lanes blocks = __builtin_shufflevector(strip, strip, 1, 2, 3, 3) - strip;
        sum += down.weight[j] * __builtin_convertvector(blocks, Doubles);
      }
      sum *= weights;
      out[c] = sum[0] + sum[1] + sum[2];
    }
  }
}

template <int channels, class Entry>
void means_in_pieces(const TableView<Entry>& table, const TexelRuns& across, const TexelRuns& down,
                     double* out) {
  for (int c = 0; c < channels; ++c) {
    out[c] = 0;
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t i = 0; i < 3; ++i)
        out[c] += across.weight[i] * down.weight[j] *
                  sum_in_pieces(table, across.edge[i], across.edge[i + 1], down.edge[j], down.edge[j + 1], c);
  }
}

}  // namespace summed_area

/// The mean over a box of what the entries of a table sum, one a channel.
template <int channels, class Entry>
void box_means(const TableView<Entry>& table, const Box& box, double* out) {
  const TexelRuns across = texel_runs(box.x0, box.x1, table.width),
                  down = texel_runs(box.y0, box.y1, table.height);
  if constexpr (summed_area::wraps<Entry>) {
    const std::int64_t texels = std::int64_t(across.edge[3] - across.edge[0]) * (down.edge[3] - down.edge[0]);
    if (texels > summed_area::unwrapped_texels)
      return summed_area::means_in_pieces<channels>(table, across, down, out);
  }
  summed_area::means<channels>(table, across, down, out);
}

}  // namespace treeline::shading::texture
