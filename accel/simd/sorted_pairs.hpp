// The k best neighbours so far as a sorted list of distances in double and ids, in registers.
//
// SortedKeys (sorted_keys.hpp) packs distance and id into one double; a distance in double leaves no room for
// that. Ids move along instead, as bits in registers of their own, chosen by the comparisons that move the
// distances. Equal distances, which ids must settle, are rare and take the slow way.
#pragma once

#include <algorithm>
#include <bit>
#include <span>

#include "accel/simd/doubles16.hpp"

namespace treeline::accel::simd {

/// Room for Size neighbours, a multiple of 8; the k wanted ones are the last, those before them are nearer
/// than any.
template <int Size>
class SortedPairs {
 public:
  static constexpr int prefetched = 2;

  /// Distances above `within` are not wanted. `out` gets the neighbours when the list is finished.
  SortedPairs(std::span<Neighbor<double>> out, double within) : out_(out) {
    const std::size_t none = Size - out.size();
    List list;
    std::fill_n(list.distance2, none, -std::numeric_limits<double>::infinity());
    std::fill_n(list.distance2 + none, out.size(), within);
    std::fill_n(list.id, Size, bits(no_id));
    load_from(list);
  }
  Neighbor<double> worst() const {
    return {last_lane(distance2_[regs - 1]), id_of(last_lane(id_[regs - 1]))};
  }
  void offer(double distance2, Id id) {
    const DoubleReg x = broadcast(distance2), x_id = broadcast(bits(id));
    std::uint32_t equal = 0;
    for (int i = 0; i < regs; ++i) equal |= bits_le(x, distance2_[i]) & bits_le(distance2_[i], x);
    if (equal != 0) [[unlikely]]
      return offer_equal(distance2, id);
    DoubleReg below = broadcast(-std::numeric_limits<double>::infinity()), below_id = x_id;
    for (int i = 0; i < regs; ++i) {
      const DoubleReg here = distance2_[i], here_id = id_[i];
      const DoubleReg moved = moved_up(below, here), moved_id = moved_up(below_id, here_id);
      distance2_[i] = chosen_lt(x, here, chosen_lt(x, moved, moved, x), here);
      id_[i] = chosen_lt(x, here, chosen_lt(x, moved, moved_id, x_id), here_id);
      below = here, below_id = here_id;
    }
  }
  void finish() const {
    List list;
    store_to(list);
    for (std::size_t i = 0, j = Size - out_.size(); i < out_.size(); ++i, ++j)
      out_[i] = {list.distance2[j], id_of(list.id[j])};
  }

 private:
  static constexpr int width = double_width, regs = Size / width;
  struct List {
    alignas(64) double distance2[Size], id[Size];
  };
  static double bits(Id id) { return std::bit_cast<double>(std::uint64_t{id}); }
  static Id id_of(double bits) { return static_cast<Id>(std::bit_cast<std::uint64_t>(bits)); }

  void load_from(const List& list) {
    for (int i = 0; i < regs; ++i)
      distance2_[i] = load(list.distance2 + i * width), id_[i] = load(list.id + i * width);
  }
  void store_to(List& list) const {
    for (int i = 0; i < regs; ++i)
      store(list.distance2 + i * width, distance2_[i]), store(list.id + i * width, id_[i]);
  }
  [[gnu::noinline]] void offer_equal(double distance2, Id id) {
    const Neighbor<double> candidate{distance2, id};
    if (!(candidate < worst())) return;
    List list;
    store_to(list);
    int i = Size - 1;
    for (; i > 0 && candidate < Neighbor<double>{list.distance2[i - 1], id_of(list.id[i - 1])}; --i)
      list.distance2[i] = list.distance2[i - 1], list.id[i] = list.id[i - 1];
    list.distance2[i] = distance2, list.id[i] = bits(id);
    load_from(list);
  }

  DoubleReg distance2_[regs], id_[regs];
  std::span<Neighbor<double>> out_;
};

}  // namespace treeline::accel::simd
