// How much light passes stacked blockers through moments of depth, by formula; and how far from that an
// answer may be, as receivers stand apart and float rounds.
//
// All blockers lie before the receiver, so that nothing should pass. By q, a polynomial of degree two that is
// 1 at the receiver's depth t and grows from there on, at most E[q²] passes, whatever has the moments in
// question; four moments know E[q²], and the least of all q is what passes. Two moments know only squares of
// lines: that is Chebyshev's bound.
#pragma once

#include <functional>
#include <vector>

namespace treeline::bench::shadow {

/// Depths in shares of the map's range, the blockers' from the light on.
struct Stack {
  std::vector<double> blockers;  ///< two or three
  double receiver = 1;
};

/// Receivers on a line beneath the blockers' edges, and a filter around each.
struct Sweep {
  /// The share of the filter that sees each blocker, by how far, in the filter's sides, the receiver is from
  /// the edges' crossing: -1 to 1.
  std::function<std::vector<double>(double at)> shares;
  double step = 0;  ///< from one receiver to the next, in the filter's sides
  int side = 1;     ///< of the filter, in texels
};

struct Leak {
  double most = 0;   ///< the share that passes, where it is largest
  double slack = 0;  ///< what of it is lost between two receivers, or changed by rounding
};

Leak leak_of_two_moments(const Stack&, const Sweep&);
/// alpha: the share of the moments that is given up (hamburger.hpp).
Leak leak_of_four_moments(const Stack&, const Sweep&, double alpha);

}  // namespace treeline::bench::shadow
