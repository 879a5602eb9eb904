// Running sums of a texture over columns and rows, in one pass: the build of every summed-area table.
//
// Four rows go through registers side by side. Within a register the sums of a row are found by doubling
// steps (Hillis and Steele 1986), a channel's lanes apart from the others'; the last pixel is carried on to
// the next register. To them come the sums of the column above, kept in a buffer of one row that stays in the
// cache: the table itself is written once and never read. Tables too large for the cache are written past it.
// Tiles of several threads wait for each other (wavefront.hpp), so that the order of additions, and with it
// every bit, does not depend on their number. It does depend on the width of a register where sums round.
// Cost: the memory traffic of reading the texture and writing the table. Known weakness: three channels fill
// registers unevenly, at one more step.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "accel/simd/lanes.hpp"
#include "shading/texture/region_averager.hpp"
#include "shading/texture/wavefront.hpp"

namespace treeline::shading::texture {

/// Entry (x, y, c) is the sum of channel c over the texels left of x and above y.
template <class Entry>
struct TableView {
  const Entry* origin = nullptr;
  std::ptrdiff_t stride = 0;                ///< entries from one row to the next
  int width = 0, height = 0, channels = 0;  ///< of the texture

  const Entry* at(int x, int y) const {
    return origin + static_cast<std::ptrdiff_t>(y) * stride + static_cast<std::ptrdiff_t>(x) * channels;
  }
};

/// The memory of a table: rows end padded, and the entry beside column 0 lies on a cache line. It is kept
/// from one build to the next if the sides stay.
template <class Entry>
class Table {
 public:
  static constexpr std::size_t line = 64, in_line = line / sizeof(Entry);

  void resize(int width, int height, int channels) {
    if (view_.origin && view_.width == width && view_.height == height && view_.channels == channels) return;
    const std::size_t row = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
    const std::size_t stride = (row + in_line - 1) / in_line * in_line + in_line;
    count_ = stride * (static_cast<std::size_t>(height) + 1);
    entries_.reset();
    entries_.reset(static_cast<Entry*>(::operator new[](count_ * sizeof(Entry), std::align_val_t(line))));
    view_ = {entries_.get() + in_line - channels, static_cast<std::ptrdiff_t>(stride), width, height,
             channels};
    std::memset(static_cast<void*>(entries_.get()), 0, stride * sizeof(Entry));
    for (int y = 1; y <= height; ++y)
      std::memset(static_cast<void*>(const_cast<Entry*>(view_.at(0, y))), 0,
                  static_cast<std::size_t>(channels) * sizeof(Entry));
  }
  const TableView<Entry>& view() const { return view_; }
  /// Of the texel in column x and row y: one line past the column and the row of zeros.
  Entry* row(int y) { return const_cast<Entry*>(view_.at(1, y + 1)); }
  std::size_t bytes() const { return count_ * sizeof(Entry); }

 private:
  struct Free {
    void operator()(Entry* p) const { ::operator delete[](p, std::align_val_t(line)); }
  };
  std::unique_ptr<Entry[], Free> entries_;
  std::size_t count_ = 0;
  TableView<Entry> view_;
};

namespace prefix {

template <class T, int lanes>
struct VectorOf {
  typedef T type __attribute__((vector_size(lanes * sizeof(T))));
};
template <class T, int lanes>
using Vector = typename VectorOf<T, lanes>::type;

/// As many as a register holds, but a pixel at least.
template <class Entry>
inline constexpr int lanes = std::max(most_channels,
                                      accel::simd::register_bytes / static_cast<int>(sizeof(Entry)));

template <class Entry>
using Register = Vector<Entry, lanes<Entry>>;

// By reference: without wide registers, passing them by value would depend on the compiler's version.

/// Adds the lanes moved up by n; zeros come in.
template <int n, class Entry, int... i>
[[gnu::always_inline]] inline void add_moved_up(Register<Entry>& v, std::integer_sequence<int, i...>) {
  v += __builtin_shufflevector(v, Register<Entry>{}, (i < n ? lanes<Entry> + i : i - n)...);
}
/// Every lane's channel from the last pixel, as the next register needs it.
template <int channels, class Entry, int... i>
[[gnu::always_inline]] inline void last_pixel(const Register<Entry>& v, Register<Entry>& to,
                                              std::integer_sequence<int, i...>) {
  constexpr int n = lanes<Entry>;
  to = __builtin_shufflevector(v, v, (i % channels + n - channels)...);
}
/// Each lane becomes the sum of those of its channel up to it.
template <int channels, class Entry>
[[gnu::always_inline]] inline void scan(Register<Entry>& v) {
  constexpr std::make_integer_sequence<int, lanes<Entry>> all;
  if constexpr (channels < lanes<Entry>) add_moved_up<channels, Entry>(v, all);
  if constexpr (2 * channels < lanes<Entry>) add_moved_up<2 * channels, Entry>(v, all);
  if constexpr (4 * channels < lanes<Entry>) add_moved_up<4 * channels, Entry>(v, all);
  if constexpr (8 * channels < lanes<Entry>) add_moved_up<8 * channels, Entry>(v, all);
}

template <bool past_cache, class Vec>
[[gnu::always_inline]] inline void put(const Vec& v, void* to) {
#if TREELINE_SIMD == 512
  if constexpr (past_cache && sizeof(Vec) == 64)
    return _mm512_stream_si512(static_cast<__m512i*>(to), (__m512i)v);
#elif TREELINE_SIMD == 256
  if constexpr (past_cache && sizeof(Vec) == 32)
    return _mm256_stream_si256(static_cast<__m256i*>(to), (__m256i)v);
#endif
  std::memcpy(to, &v, sizeof v);
}

/// Tables above this many bytes do not stay in the cache anyway, beside the texture.
inline constexpr std::size_t cached_bytes = std::size_t{2} << 20;

inline constexpr int band = 4;              ///< rows side by side
inline constexpr int tile_rows = 64;        ///< that a thread takes at once
inline constexpr int tile_bytes = 1 << 12;  ///< of a row of the table

/// One tile's rows from `y` on, entries [begin, end) of each; begin and the tile's width are whole
/// registers but at the right border. `above` is the row of column sums, `left` the carries of these rows, or
/// null for tiles that begin at the left border and end at the right one.
template <int rows, int channels, bool past_cache, class Source, class Entry>
void tile_rows_at(const Source& source, int y, std::size_t begin, std::size_t end, Entry* above,
                  Register<Entry>* left, Table<Entry>& table) {
  constexpr std::size_t n = lanes<Entry>;
  Source here = source;  // may keep count of what it meets
  Register<Entry> carry[rows] = {};
  if (left)
    for (int r = 0; r < rows; ++r) carry[r] = left[y + r];
  const float* from[rows];
  Entry* to[rows];
  for (int r = 0; r < rows; ++r) from[r] = here.row(y + r), to[r] = table.row(y + r);
  const auto step = [&](std::size_t x, const float* const* p, std::size_t offset) {
    Register<Entry> sum;
    std::memcpy(&sum, above + x, sizeof sum);
#pragma GCC unroll 8  // or carries go through memory
    for (int r = 0; r < rows; ++r) {
      Register<Entry> v;
      here.template load<channels>(p[r] + offset, x, v);
      scan<channels, Entry>(v);
      v += carry[r];
      last_pixel<channels, Entry>(v, carry[r], std::make_integer_sequence<int, lanes<Entry>>{});
      sum += v;
      put<past_cache>(sum, to[r] + x);
    }
    std::memcpy(above + x, &sum, sizeof sum);
  };
  std::size_t x = begin;
  for (; x + n <= end; x += n) step(x, from, x);
  if (x < end) {
    float rest[rows][n] = {};
    const float* p[rows];
    for (int r = 0; r < rows; ++r) std::copy(from[r] + x, from[r] + end, rest[r]), p[r] = rest[r];
    step(x, p, 0);
  }
  if (left)
    for (int r = 0; r < rows; ++r) left[y + r] = carry[r];
  here.leave();
}

}  // namespace prefix

/// Fills the table with the sums of what the source makes of the texture's values: source.row(y) points to a
/// row of floats, source.load<channels>(p, x, to) makes a register of entries of those at p, the values from
/// number x of their row on; behind the last of them there are zeros. A copy of the source serves a tile's
/// rows; leave() is called when they are done.
template <class Source, class Entry>
void sum_up(const Source& source, const Image& image, Table<Entry>& table, int threads) {
  using namespace prefix;
  table.resize(image.width, image.height, image.channels);
  const std::size_t width = image.index(0, 1), height = static_cast<std::size_t>(image.height);
  constexpr std::size_t n = lanes<Entry>;
  // On one thread a tile is as wide as the texture.
  const std::size_t wide = threads == 1 ? (width + n - 1) / n * n : tile_bytes / sizeof(Entry);
  const int columns = static_cast<int>((width + wide - 1) / wide);
  const int bands = static_cast<int>((height + tile_rows - 1) / tile_rows);
  std::vector<Register<Entry>> left(columns > 1 ? height : 0);
  const std::size_t padded = (width + n - 1) / n * n;
  std::vector<Entry> above(padded);
  const bool past_cache = table.bytes() > cached_bytes;
  with_channels(image.channels, [&](auto count) {
    constexpr int channels = count;
    wavefront(bands, columns, threads, [&](int r, int c) {
      const std::size_t begin = static_cast<std::size_t>(c) * wide, end = std::min(width, begin + wide);
      const int top = r * tile_rows, bottom = std::min(image.height, top + tile_rows);
      const auto fill = [&](auto past) {
        Register<Entry>* carries = columns > 1 ? left.data() : nullptr;
        int y = top;
        for (; y + band <= bottom; y += band)
          tile_rows_at<band, channels, past>(source, y, begin, end, above.data(), carries, table);
        for (; y < bottom; ++y)
          tile_rows_at<1, channels, false>(source, y, begin, end, above.data(), carries, table);
      };
      past_cache ? fill(std::true_type{}) : fill(std::false_type{});
#if TREELINE_SIMD >= 256
      if (past_cache) _mm_sfence();
#endif
    });
  });
}

}  // namespace treeline::shading::texture
