#include "bench/knn/questions.hpp"

#include <algorithm>
#include <stdexcept>

#include "bench/knn/parallel.hpp"
#include "bench/knn/truth.hpp"
#include "geometry/random.hpp"
#include "geometry/sampling.hpp"

namespace treeline::bench::knn {

using geometry::Box;
using geometry::Vec;
using geometry::Vec3d;
using geometry::Vec3f;

namespace {

constexpr std::size_t average = 30;         // neighbours of a radius or box query
constexpr std::size_t sampled_points = 64;  // on which radius and box are sized
constexpr double enlarged = 0.1;            // of the box's widest side, for queries off the cloud
constexpr std::size_t most_far = 64;        // a tree that bounds by planes visits every leaf for each of them
constexpr double nearest_far = 2, farthest_far = 4;  // diagonals of the box from its centre

// The first `count` of a random permutation of [0, n) (Fisher and Yates).
std::vector<std::uint32_t> random_choice(std::size_t n, std::size_t count, geometry::Pcg32& random) {
  std::vector<std::uint32_t> numbers(n);
  for (std::size_t i = 0; i < n; ++i) numbers[i] = static_cast<std::uint32_t>(i);
  count = std::min(n, count);
  for (std::size_t i = 0; i < count; ++i)
    std::swap(numbers[i], numbers[i + random.below(static_cast<std::uint32_t>(n - i))]);
  numbers.resize(count);
  return numbers;
}

template <class T>
std::vector<Vec<T, 3>> off_cloud(const Box<T, 3>& box, std::size_t count, geometry::Pcg32& random) {
  const T margin = static_cast<T>(enlarged / 2) * box.extent()[box.widest_axis()];
  std::vector<Vec<T, 3>> r(count);
  for (auto& p : r)
    for (int a = 0; a < 3; ++a) p[a] = random.uniform<T>(box.low[a] - margin, box.high[a] + margin);
  return r;
}

template <class T>
std::vector<Vec<T, 3>> far_around(const Box<T, 3>& box, std::size_t count, geometry::Pcg32& random) {
  constexpr double largest = std::numeric_limits<T>::max();
  const Vec3d low(box.low), high(box.high), centre = (low + high) * 0.5;
  const double diagonal = length(high - low);
  std::vector<Vec<T, 3>> r(count);
  for (auto& p : r) {
    const double u = random.uniform<double>(), v = random.uniform<double>();
    const double away = diagonal * random.uniform<double>(nearest_far, farthest_far);
    const Vec3d at = centre + geometry::sample_sphere(u, v) * away;
    for (int a = 0; a < 3; ++a) p[a] = static_cast<T>(std::clamp(at[a], -largest, largest));
  }
  return r;
}

// The bits of x in every third place (Morton 1966), for x below 2^21.
std::uint64_t spread_bits(std::uint64_t x) {
  std::uint64_t r = 0;
  for (int bit = 0; bit < 21; ++bit) r |= (x >> bit & 1) << (3 * bit);
  return r;
}

// Numbers of the points along a Morton curve through the box.
template <class T>
std::vector<std::uint32_t> morton_order(const std::vector<Vec<T, 3>>& points, const Box<T, 3>& box) {
  constexpr double cells = 1 << 21;
  const double widest = box.extent()[box.widest_axis()];
  std::vector<std::pair<std::uint64_t, std::uint32_t>> codes;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::uint64_t code = 0;
    for (int a = 0; a < 3 && widest > 0; ++a) {
      const double share = (double(points[i][a]) - box.low[a]) / widest;
      code |= spread_bits(static_cast<std::uint64_t>(std::min(share * cells, cells - 1))) << a;
    }
    codes.emplace_back(code, static_cast<std::uint32_t>(i));
  }
  std::sort(codes.begin(), codes.end());
  std::vector<std::uint32_t> order;
  for (const auto& [code, number] : codes) order.push_back(number);
  return order;
}

// The distance that holds `average` points a query on average, pooled over the sampled ones: since no query
// can hold more than all of the pool, the nearest average·samples of each are enough.
template <class Point, class Nearest>
double pooled_distance(const std::vector<Point>& sample, int threads, Nearest nearest) {
  const std::size_t pool = average * sample.size();
  std::vector<std::vector<double>> each(sample.size());
  parallel_chunks(sample.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const ScanFound& f : nearest(sample[i], pool)) each[i].push_back(f.distance2);
  });
  std::vector<double> all;
  for (const auto& e : each) all.insert(all.end(), e.begin(), e.end());
  const std::size_t rank = std::min(pool, all.size()) - 1;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(rank), all.end());
  // Halfway to the next distance, so that the border holds no point of the sample.
  const double last = std::sqrt(all[rank]);
  if (rank + 1 == all.size()) return last * 1.0001;
  return (last +
          std::sqrt(*std::min_element(all.begin() + static_cast<std::ptrdiff_t>(rank) + 1, all.end()))) /
         2;
}

template <class T>
double median_spacing(const ScanOf<T>& cloud, const std::vector<Vec<T, 3>>& sample) {
  std::vector<double> d;
  for (const auto& p : sample) {
    const auto found = cloud.nearest(p, 2);
    if (found.size() == 2) d.push_back(std::sqrt(found[1].distance2));
  }
  if (d.empty()) return 0;
  const auto middle = d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2);
  std::nth_element(d.begin(), middle, d.end());
  return *middle;
}

template <class T>
Box<T, 3> cube(const Vec<T, 3>& centre, T half) {
  const auto h = Vec<T, 3>::filled(half);
  return {centre - h, centre + h};
}

}  // namespace

template <class T>
QuestionsOf<T> questions_about(const ScanOf<T>& cloud, std::size_t count, std::uint64_t seed, int threads) {
  if (cloud.size() == 0) throw std::invalid_argument("the cloud has no finite point to ask about");
  using Kind = QuestionKinds::Kind;
  using Point = Vec<T, 3>;
  geometry::Pcg32 random(seed, 7);  // a stream of its own, apart from the recipes'
  QuestionsOf<T> q;
  std::vector<Point>& self = q.points[QuestionKinds::self];
  const Box<T, 3> box = cloud.box();
  for (const std::uint32_t i : random_choice(cloud.size(), count, random)) self.push_back(cloud.point(i));
  q.points[QuestionKinds::off] = off_cloud(box, count, random);
  q.points[QuestionKinds::far] = far_around(box, std::min(count, most_far), random);
  q.order = morton_order(self, box);
  for (const std::uint32_t i : q.order) q.points[QuestionKinds::sorted].push_back(self[i]);

  std::vector<Point> sample;
  for (const std::uint32_t i : spread_sample(self.size(), sampled_points)) sample.push_back(self[i]);
  q.radius = static_cast<T>(
      pooled_distance(sample, threads, [&](const Point& p, std::size_t k) { return cloud.nearest(p, k); }));
  const auto half = static_cast<T>(pooled_distance(
      sample, threads, [&](const Point& p, std::size_t k) { return cloud.nearest_by_cube(p, k); }));
  for (const Point& p : self) q.boxes.push_back(cube(p, half));
  q.spacing = median_spacing(cloud, sample);

  q.sets = {{"knn1_self", Kind::nearest, 1, QuestionKinds::self},
            {"knn8_self", Kind::nearest, 8, QuestionKinds::self},
            {"knn8_sorted", Kind::nearest, 8, QuestionKinds::sorted},
            {"knn32_self", Kind::nearest, 32, QuestionKinds::self},
            {"knn100_self", Kind::nearest, 100, QuestionKinds::self},
            {"knn1_off", Kind::nearest, 1, QuestionKinds::off},
            {"knn8_off", Kind::nearest, 8, QuestionKinds::off},
            {"knn32_off", Kind::nearest, 32, QuestionKinds::off},
            {"knn8_far", Kind::nearest, 8, QuestionKinds::far},
            {"radius_self", Kind::within, 0, QuestionKinds::self},
            {"box_self", Kind::inside, 0, QuestionKinds::self}};
  return q;
}

template QuestionsOf<float> questions_about(const ScanOf<float>&, std::size_t, std::uint64_t, int);
template QuestionsOf<double> questions_about(const ScanOf<double>&, std::size_t, std::uint64_t, int);

Questions questions_of(const datasets::HardCase& hard_case, const DoubleScan& cloud) {
  using Kind = Questions::Kind;
  Questions q;
  const std::vector<Vec3f>& self = q.points[Questions::self] = hard_case.queries;
  q.sets.push_back({"knn" + std::to_string(hard_case.k), Kind::nearest, hard_case.k, Questions::self});
  std::vector<Vec3f> sample;
  for (const std::uint32_t i : spread_sample(cloud.size(), sampled_points)) sample.push_back(cloud.point(i));
  q.spacing = median_spacing(cloud, sample);
  if (!hard_case.radius) return q;
  q.radius = *hard_case.radius;
  q.sets.push_back({"radius", Kind::within, 0, Questions::self});
  if (!(q.radius >= 0)) return q;
  for (const Vec3f& p : self)
    if (!geometry::is_finite(p)) return q;
  for (const Vec3f& p : self) q.boxes.push_back(cube(p, q.radius));
  q.sets.push_back({"box", Kind::inside, 0, Questions::self});
  return q;
}

}  // namespace treeline::bench::knn
