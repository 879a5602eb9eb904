// Means of many samples where there is room for floats only, as on a GPU or in an image of floats.
//
// Problem: a sum of floats stops growing where what is added is less than half its last digit: of ones, at
// 2^24 of them; of 1e8 numbers even over [0, 1) the mean comes out as 0.168. A running mean,
// m += (x - m) / n, does not stop but drifts: 0.49993. Blocks of 4096, each summed by itself before it is
// added, are right to 1e-6 there; so is a sum beside which a second float keeps what the first one lost
// (Kahan 1965). Cost: one addition; a division; one addition and a bit; four. Film adds in double, which
// takes the room of Kahan's two floats and is more exact. Known weakness: blocks stop in their turn, after
// 2^24 of them; Kahan's needs a compiler that does not reorder sums (no -ffast-math).
#pragma once

#include <cstdint>

namespace treeline::shading::transport {

/// Stops growing.
class PlainSum {
 public:
  void add(float x) { sum_ += x, ++n_; }
  float mean() const { return n_ > 0 ? sum_ / static_cast<float>(n_) : 0; }

 private:
  float sum_ = 0;
  std::uint64_t n_ = 0;
};

/// Drifts.
class RunningMean {
 public:
  void add(float x) { mean_ += (x - mean_) / static_cast<float>(++n_); }
  float mean() const { return mean_; }

 private:
  float mean_ = 0;
  std::uint64_t n_ = 0;
};

class BlockSum {
 public:
  void add(float x) {
    block_ += x;
    if (++n_ % 4096 == 0) blocks_ += block_, block_ = 0;
  }
  float mean() const { return n_ > 0 ? (blocks_ + block_) / static_cast<float>(n_) : 0; }

 private:
  float block_ = 0, blocks_ = 0;
  std::uint64_t n_ = 0;
};

class KahanSum {
 public:
  void add(float x) {
    const float corrected = x - lost_, sum = sum_ + corrected;
    lost_ = (sum - sum_) - corrected;
    sum_ = sum, ++n_;
  }
  float mean() const { return n_ > 0 ? (sum_ - lost_) / static_cast<float>(n_) : 0; }

 private:
  float sum_ = 0, lost_ = 0;
  std::uint64_t n_ = 0;
};

}  // namespace treeline::shading::transport
