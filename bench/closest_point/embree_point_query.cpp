// Embree's point query: rtcPointQuery walks the tree and calls back for each triangle in reach.
//
// Embree measures no triangles itself. The knob kernel chooses what the callback measures with: `textbook` is
// the one of its own tutorial (Ericson 2005, section 5.1.5), in float; `edges` tries the three edges and the
// plane, in float; `double` does that in double, and answers in double.
// Claim: approximate. The tree's boxes and the query's radius are floats, compared without an allowance for
// rounding, and the float kernels lose slivers.
#include "accel/batch.hpp"
#include "bench/closest_point/method.hpp"
#include "bench/ray/embree.hpp"
#include "geometry/distance.hpp"

namespace treeline::bench::closest_point {
namespace {

using geometry::Vec3f;

/// Ericson 2005, section 5.1.5: by the Voronoi regions of corners, edges and face.
Vec3f textbook(const Vec3f& p, const geometry::Triangle3f& t) {
  const Vec3f ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return t.a;
  const Vec3f bp = p - t.b;
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return t.b;
  const Vec3f cp = p - t.c;
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return t.c;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return t.a + ab * (d1 / (d1 - d3));
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return t.a + ac * (d2 / (d2 - d6));
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return t.b + (t.c - t.b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const float scale = 1 / (va + vb + vc);
  return t.a + ab * (vb * scale) + ac * (vc * scale);
}

struct Textbook {
  using Scalar = float;
  static void measure(const Vec3f& p, const geometry::Triangle3f& t, accel::ClosestPoint<float>& found) {
    found.point = textbook(p, t), found.distance2 = length2(p - found.point);
  }
};

template <class T>
struct Edges {
  using Scalar = T;
  static void measure(const geometry::Vec<T, 3>& p, const geometry::Triangle3f& t,
                      accel::ClosestPoint<T>& found) {
    const auto on = geometry::closest_point_on_triangle(p, geometry::Triangle<T>(t));
    found.point = on.point, found.distance2 = on.distance2;
    found.feature = static_cast<accel::Feature>(on.feature);
  }
};

template <class Kernel>
struct Search {
  geometry::Vec<typename Kernel::Scalar, 3> query;
  const geometry::Triangle3f* triangles;
  accel::ClosestPoint<typename Kernel::Scalar> best{};
};

/// Called for each triangle in reach; true if the reach has shrunk.
template <class Kernel>
bool try_triangle(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<Search<Kernel>*>(arguments->userPtr);
  accel::ClosestPoint<typename Kernel::Scalar> found;
  Kernel::measure(search.query, search.triangles[arguments->primID], found);
  if (!(found.distance2 < search.best.distance2)) return false;
  search.best = found, search.best.primitive = arguments->primID;
  const auto radius = static_cast<float>(std::sqrt(found.distance2));
  // One that float rounded down would cut off what double can still tell to be nearer.
  arguments->query->radius =
      std::is_same_v<typename Kernel::Scalar, double> ? radius * (1 + 0x1p-23f) : radius;
  return true;
}

class EmbreePointQuery final : public Index {
 public:
  EmbreePointQuery(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads)
      : scene_(mesh, knobs, threads), triangles_(geometry::triangles_of(mesh)) {}

  void closest(const Queries& queries, Answers& out, const Knobs& knobs, int threads) const override {
    const auto kernel = knobs.value("kernel", "textbook");
    if (kernel == "double")
      return run<Edges<double>>(queries.doubles, out.fill<double>(queries.size()), threads);
    if (kernel == "edges") return run<Edges<float>>(queries.floats, out.fill<float>(queries.size()), threads);
    run<Textbook>(queries.floats, out.fill<float>(queries.size()), threads);
  }

 private:
  template <class Kernel, class T>
  void run(const std::vector<geometry::Vec<T, 3>>& queries, std::span<accel::ClosestPoint<T>> out,
           int threads) const {
    accel::parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      const ray::FlushDenormals flush;
      for (std::size_t i = begin; i < end; ++i) {
        const geometry::Vec3f q(queries[i]);
        Search<Kernel> search{queries[i], triangles_.data()};
        RTCPointQuery query{};
        query.x = q[0], query.y = q[1], query.z = q[2], query.time = 0;
        query.radius = std::numeric_limits<float>::infinity();
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        rtcPointQuery(scene_.scene(), &query, &context, try_triangle<Kernel>, &search);
        out[i] = search.best;
      }
    });
  }

  ray::EmbreeScene scene_;
  std::vector<geometry::Triangle3f> triangles_;  // in one piece: nearer than through indices
};

std::vector<Knobs> builds() {
  std::vector<Knobs> all;
  for (const char* quality : {"medium", "high", "low"}) all.push_back(Knobs{{"quality", quality}});
  all.push_back(Knobs{{"quality", "medium"}, {"compact", true}});
  return all;
}

const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "embree_point_query",
              .family = "bvh",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = ray::embree_version(),
              .build_knobs = builds(),
              .query_knobs = {Knobs{{"kernel", "textbook"}}, Knobs{{"kernel", "edges"}},
                              Knobs{{"kernel", "double"}}},
              .ladder = 60,
              .quick_builds = 1},
     .build = [](const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) -> std::unique_ptr<Index> {
       return std::make_unique<EmbreePointQuery>(mesh, knobs, threads);
     },
     .warm_up = ray::warm_up_embree});

}  // namespace
}  // namespace treeline::bench::closest_point
