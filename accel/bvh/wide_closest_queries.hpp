// The public closest-point queries of the wide tree over triangles: checks of what is asked, batches in an
// order that the caches like, answers in the user's units.
//
// A tree derives from this (statically; nothing is virtual) and supplies
//   template <class F> void each_closest_space(F&& f) const;   // the first takes hints
#pragma once

#include "accel/batch.hpp"
#include "accel/bvh/wide_closest_group.hpp"
#include "accel/query_order.hpp"
#include "accel/ray_checks.hpp"

namespace treeline::accel {

struct ClosestOptions {
  float max_distance = std::numeric_limits<float>::infinity();  ///< nothing farther is returned; inclusive
  /// Which triangle is nearest is decided exactly, and the squared distance is the true one rounded once.
  /// Without, all of it is as double finds it: of triangles whose distances agree to some 15 digits either
  /// may be returned. The triangles are those that the tree keeps: where the typical coordinate is beyond
  /// 2^±21 they are scaled to about 1 (triangle_scale.hpp), and coordinates below 2^-126 of the typical one
  /// then lose digits, below 2^-149 they vanish. In such meshes of mixed scale exact answers are those of the
  /// tree's triangles, not of the user's.
  bool exact = false;
};

/// In which order a batch is worked on; the answers are the same.
enum class QueryOrder {
  automatic,  ///< along a curve, where there are enough queries for that to pay
  given,      ///< as they come
  curve       ///< along a curve through space, neighbours together (query_order.hpp, wide_closest_group.hpp)
};

template <class Tree, class Layout>
class WideClosestQueries {
 public:
  using ClosestPointOf = geometry::Vec<float, 3>;

  /// The nearest point of all triangles, those without an area included, if at a distance of at most
  /// max_distance. Ties in distance go to the lower id. Throw InvalidInput for a query that is not finite, a
  /// max_distance that is negative or NaN, a batch whose room for answers is not as many as its queries,
  /// threads < 1.
  ClosestPoint<float> closest_point(const ClosestPointOf& query,
                                    float max_distance = std::numeric_limits<float>::infinity()) const {
    NoWork work;
    return closest_point(query, max_distance, work);
  }
  template <WorkCounter W>
  ClosestPoint<float> closest_point(const ClosestPointOf& query, float max_distance, W& work) const {
    check(query), check(max_distance);
    return answer<float, false>({query, static_cast<double>(max_distance)}, work);
  }
  /// T: float, or double for point and squared distance in double.
  template <class T = float>
  ClosestPoint<T> closest_point(const ClosestPointOf& query, const ClosestOptions& options) const {
    check(query), check(options.max_distance);
    NoWork work;
    const wide::ClosestQuestion question{query, static_cast<double>(options.max_distance)};
    return options.exact ? answer<T, true>(question, work) : answer<T, false>(question, work);
  }

  void closest_point(std::span<const ClosestPointOf> queries, float max_distance,
                     std::span<ClosestPoint<float>> out, int threads) const {
    closest_point<float>(queries, ClosestOptions{max_distance}, out, threads);
  }
  template <class T>
  void closest_point(std::span<const ClosestPointOf> queries, const ClosestOptions& options,
                     std::span<ClosestPoint<T>> out, int threads,
                     QueryOrder order = QueryOrder::automatic) const {
    check(options.max_distance);
    check_room(queries.size(), out.size());
    for (std::size_t i = 0; i < queries.size(); ++i)
      if (!is_finite(queries[i]))
        throw InvalidInput("query " + std::to_string(i) + " has a coordinate that is not finite");
    check_threads(threads);
    options.exact ? answer_all<T, true>(queries, options.max_distance, out, threads, order)
                  : answer_all<T, false>(queries, options.max_distance, out, threads, order);
  }

 private:
  /// Queries in a batch from which sorting pays.
  static constexpr std::size_t worth_sorting = 512;

  const Tree& tree() const { return static_cast<const Tree&>(*this); }

  static void check(const ClosestPointOf& query) {
    if (!is_finite(query)) throw InvalidInput("query has a coordinate that is not finite");
  }
  static void check(float max_distance) {
    if (!(max_distance >= 0))
      throw InvalidInput("max_distance is " + std::to_string(max_distance) + "; it must not be negative");
  }

  template <bool exact, class W>
  void find(const wide::ClosestQuestion& question, wide::ClosestSoFar& best, wide::Ref hint, W& work) const {
    tree().each_closest_space([&](const wide::ClosestSpace& space) {
      wide::ClosestSearch<Layout, exact>(space, question, best).run(hint, work);
      hint = wide::no_ref;
    });
  }
  int spaces() const {
    int count = 0;
    tree().each_closest_space([&](const wide::ClosestSpace&) { ++count; });
    return count;
  }
  template <class T, bool exact, class W>
  ClosestPoint<T> answer(const wide::ClosestQuestion& question, W& work) const {
    wide::ClosestSoFar best;
    find<exact>(question, best, wide::no_ref, work);
    return given<T, exact>(question, best);
  }
  template <class T, bool exact>
  static ClosestPoint<T> given(const wide::ClosestQuestion& question, const wide::ClosestSoFar& best) {
    ClosestPoint<T> out;
    if (best.id == no_id) return out;
    out.primitive = best.id, out.feature = best.feature;
    out.point = geometry::Vec<T, 3>(best.point);
    out.distance2 = static_cast<T>(best.distance2);
    if constexpr (exact) {
      const int feature = best.exact->feature;  // 0 the face, then edges, then corners, as in Feature
      if (feature >= 4) out.point = geometry::Vec<T, 3>(best.exact->corner(feature - 4));
      out.feature = static_cast<Feature>(feature);
      if (static_cast<T>(best.low) != static_cast<T>(best.high))
        out.distance2 = wide::distance2<T>(geometry::Vec3d(question.point), *best.exact);
    }
    return out;
  }

  template <class T, bool exact>
  void answer_all(std::span<const ClosestPointOf> queries, float max_distance, std::span<ClosestPoint<T>> out,
                  int threads, QueryOrder how) const {
    const auto limit = static_cast<double>(max_distance);
    const bool sorts =
        how == QueryOrder::curve || (how == QueryOrder::automatic && queries.size() >= worth_sorting);
    if (!sorts) {
      parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
        NoWork work;
        for (std::size_t i = begin; i < end; ++i) out[i] = answer<T, exact>({queries[i], limit}, work);
      });
      return;
    }
    const auto order = along_curve(queries, threads);
    const auto ask_for = [&](std::size_t j) {
      const std::size_t next = order[j].value;
      __builtin_prefetch(&queries[next]), __builtin_prefetch(&out[next], 1);
    };
    if (spaces() == 1) {
      parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
        tree().each_closest_space([&](const wide::ClosestSpace& space) {
          using Groups = wide::ClosestGroups<Layout, exact>;
          Groups groups(space, limit);
          ClosestPointOf some[Groups::most];
          wide::ClosestSoFar best[Groups::most];
          for (std::size_t j = begin; j < end; j += Groups::most) {
            const std::size_t count = std::min(Groups::most, end - j);
            for (std::size_t i = j + ahead; i < std::min(j + ahead + Groups::most, end); ++i) ask_for(i);
            for (std::size_t i = 0; i < count; ++i) some[i] = queries[order[j + i].value];
            groups.find({some, count}, best);
            for (std::size_t i = 0; i < count; ++i)
              out[order[j + i].value] = given<T, exact>({some[i], limit}, best[i]);
          }
        });
      });
      return;
    }
    parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
      NoWork work;
      wide::Ref hint = wide::no_ref;
      for (std::size_t j = begin; j < end; ++j) {
        const std::size_t i = order[j].value;
        if (j + ahead < end) ask_for(j + ahead);
        const wide::ClosestQuestion question{queries[i], limit};
        wide::ClosestSoFar best;
        find<exact>(question, best, hint, work);
        if (best.leaf != wide::no_ref) hint = best.leaf;
        out[i] = given<T, exact>(question, best);
      }
    });
  }
  static constexpr std::size_t ahead = 8;  // queries whose memory is asked for
};

}  // namespace treeline::accel
