#include "bench/knn/truth.hpp"

#include <cstring>
#include <stdexcept>

#include "bench/knn/parallel.hpp"

namespace treeline::bench::knn {

using accel::Id;

namespace {
template <class T>
bool has_nan(const geometry::Vec<T, 3>& p) {
  return std::isnan(p[0]) || std::isnan(p[1]) || std::isnan(p[2]);
}
}  // namespace

std::vector<std::uint32_t> spread_sample(std::size_t size, std::size_t count) {
  count = std::min(count, size);
  std::vector<std::uint32_t> r(count);
  for (std::size_t i = 0; i < count; ++i) r[i] = static_cast<std::uint32_t>(i * size / count);
  return r;
}

std::size_t checked_queries(std::size_t n, std::size_t queries) {
  // Point-to-query distances that a second or so of one core computes.
  constexpr std::size_t affordable = 200'000'000;
  return std::min(queries, std::max<std::size_t>(100, affordable / std::max<std::size_t>(n, 1)));
}

template <class T>
NearestTruth nearest_truth(const ScanOf<T>& scan, Queries<T> queries, std::size_t k,
                           std::vector<std::uint32_t> sample, int threads) {
  NearestTruth t;
  t.k = std::min(k, scan.size());
  t.answerable.assign(sample.size(), 0);
  t.distances.assign(sample.size() * t.k, 0);
  parallel_chunks(sample.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& query = queries[sample[i]];
      if (has_nan(query)) continue;
      t.answerable[i] = 1;
      const auto found = scan.nearest(query, t.k);
      for (std::size_t j = 0; j < t.k; ++j) t.distances[i * t.k + j] = std::sqrt(found[j].distance2);
    }
  });
  t.sample = std::move(sample);
  return t;
}

namespace {
template <class Answer>
RangeTruth range_truth(std::vector<std::uint32_t> sample, int threads, Answer answer) {
  RangeTruth t;
  t.answerable.assign(sample.size(), 0);
  t.answers.resize(sample.size());
  parallel_chunks(sample.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) t.answerable[i] = answer(sample[i], t.answers[i]);
  });
  t.sample = std::move(sample);
  return t;
}

// Little-endian as in memory: the cache stays on the machine that wrote it.
class Writer {
 public:
  template <class T>
  void list(const std::vector<T>& v) {
    const std::uint64_t n = v.size();
    bytes_.append(reinterpret_cast<const char*>(&n), sizeof n);
    bytes_.append(reinterpret_cast<const char*>(v.data()), n * sizeof(T));
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  std::vector<T> list() {
    std::uint64_t n = 0;
    take(&n, sizeof n);
    if (n > bytes_.size() / sizeof(T)) throw std::invalid_argument("cached truth is cut short");
    std::vector<T> v(n);
    take(v.data(), n * sizeof(T));
    return v;
  }
  void done() const {
    if (!bytes_.empty()) throw std::invalid_argument("cached truth has bytes left over");
  }

 private:
  void take(void* to, std::size_t n) {
    if (n > bytes_.size()) throw std::invalid_argument("cached truth is cut short");
    if (n > 0) std::memcpy(to, bytes_.data(), n);
    bytes_.remove_prefix(n);
  }
  std::string_view bytes_;
};
}  // namespace

template <class T>
RangeTruth within_truth(const ScanOf<T>& scan, Queries<T> queries, double radius,
                        std::vector<std::uint32_t> sample, int threads) {
  return range_truth(std::move(sample), threads, [&](std::uint32_t query, RangeAnswer& answer) {
    if (has_nan(queries[query])) return false;
    answer = scan.within(queries[query], radius);
    return true;
  });
}

template <class T>
RangeTruth inside_truth(const ScanOf<T>& scan, Boxes<T> boxes, std::vector<std::uint32_t> sample,
                        int threads) {
  return range_truth(std::move(sample), threads, [&](std::uint32_t query, RangeAnswer& answer) {
    if (has_nan(boxes[query].low) || has_nan(boxes[query].high)) return false;
    answer = scan.inside(boxes[query]);
    return true;
  });
}

template NearestTruth nearest_truth(const ScanOf<float>&, Queries<float>, std::size_t,
                                    std::vector<std::uint32_t>, int);
template RangeTruth within_truth(const ScanOf<float>&, Queries<float>, double, std::vector<std::uint32_t>,
                                 int);
template RangeTruth inside_truth(const ScanOf<float>&, Boxes<float>, std::vector<std::uint32_t>, int);
template NearestTruth nearest_truth(const ScanOf<double>&, Queries<double>, std::size_t,
                                    std::vector<std::uint32_t>, int);
template RangeTruth within_truth(const ScanOf<double>&, Queries<double>, double, std::vector<std::uint32_t>,
                                 int);
template RangeTruth inside_truth(const ScanOf<double>&, Boxes<double>, std::vector<std::uint32_t>, int);

std::string to_bytes(const NearestTruth& t) {
  Writer w;
  w.list(std::vector<std::uint64_t>{t.k});
  w.list(t.sample), w.list(t.answerable), w.list(t.distances);
  return w.take();
}

NearestTruth nearest_from_bytes(std::string_view bytes) {
  Reader r(bytes);
  NearestTruth t;
  const auto k = r.list<std::uint64_t>();
  t.sample = r.list<std::uint32_t>(), t.answerable = r.list<std::uint8_t>(), t.distances = r.list<double>();
  r.done();
  if (k.size() != 1 || t.answerable.size() != t.sample.size() || t.distances.size() != t.sample.size() * k[0])
    throw std::invalid_argument("cached truth has lists of unequal length");
  t.k = k[0];
  return t;
}

std::string to_bytes(const RangeTruth& t) {
  Writer w;
  w.list(t.sample), w.list(t.answerable);
  for (const RangeAnswer& a : t.answers) w.list(a.must), w.list(a.may);
  return w.take();
}

RangeTruth range_from_bytes(std::string_view bytes) {
  Reader r(bytes);
  RangeTruth t;
  t.sample = r.list<std::uint32_t>(), t.answerable = r.list<std::uint8_t>();
  if (t.answerable.size() != t.sample.size())
    throw std::invalid_argument("cached truth has lists of unequal length");
  t.answers.resize(t.sample.size());
  for (RangeAnswer& a : t.answers) a.must = r.list<Id>(), a.may = r.list<Id>();
  r.done();
  return t;
}

}  // namespace treeline::bench::knn
