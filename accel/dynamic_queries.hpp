// Queries of DynamicPoints: every tree and the loose points are asked, and what they find is merged.
//
// Trees answer in squared distances of the caller's units. Where these compare as ranks do (is_sound),
// nothing is measured twice; where one does not, what the trees find is ranked anew by the measure of all
// points; and where a tree is scaled otherwise than all of them together, it is asked for all within the
// radius that the first answers give, so that nothing is lost to what it rounded differently.
#pragma once

#include "accel/dynamic_points.hpp"

namespace treeline::accel {

// ---- queries -------------------------------------------------------------------------------------------

/// What is removed takes places, so more than k are asked for.
template <NeighborIndex Tree>
std::size_t DynamicPoints<Tree>::asked_of(const Part& part, std::size_t k) const {
  const std::size_t n = part.ids.size();
  if (part.dead == 0 || k >= n) return std::min(k, n);
  const double share = static_cast<double>(part.dead) / static_cast<double>(n);
  return std::min(n, k + static_cast<std::size_t>(2 * share * static_cast<double>(k)) + 1);
}

/// Into g.best, nearest first. Found items are as good as Ranked ones while all squared distances are sound
/// and the parts alike; returns false once one is not sound. `first`: what the largest tree has told, if it
/// was asked.
template <NeighborIndex Tree>
template <class Item, class W>
bool DynamicPoints<Tree>::gather(const Point& q, const Query& query, std::size_t k,
                                 const NearestOptions<Scalar>& options, std::span<const Found> first,
                                 Scratch& s, Gathered<Item>& g, W& work) const {
  constexpr bool plain = std::is_same_v<Item, Found>;
  constexpr Scalar infinity = std::numeric_limits<Scalar>::infinity();
  const Reach<Scalar> reach = measure_.reach(options.max_distance);
  bool sound = true;
  const auto take = [&](Scalar distance2, Id id, const auto& point) {
    if constexpr (plain) {
      sound = sound && (is_sound(distance2) || (distance2 == 0 && point() == q));
      g.more.push_back({distance2, id});
    } else {
      const auto square = query.square(point());
      if (reach(square.distance2, square.wide)) g.more.push_back({query.rank(square), id});
    }
  };
  const auto worst = [&]() -> Scalar {  // or infinite
    if constexpr (plain)
      if (g.best.size() == k && is_sound(g.best.back().distance2)) return g.best.back().distance2;
    return infinity;
  };
  const auto merge = [&] {
    if (!plain) std::sort(g.more.begin(), g.more.end());
    if (g.more.empty()) return;
    if (g.best.empty()) return g.best.swap(g.more);
    g.merged.clear();
    std::merge(g.best.begin(), g.best.end(), g.more.begin(), g.more.end(), std::back_inserter(g.merged));
    if (g.merged.size() > k) g.merged.resize(k);
    g.best.swap(g.merged);
  };
  g.best.clear();
  for (const Part& part : parts_) {
    NearestOptions<Scalar> limited = options;
    if (const Scalar w = worst(); w < infinity)  // by a margin for rounding
      limited.max_distance =
          std::min(options.max_distance, std::sqrt(w) * (1 + 8 * std::numeric_limits<Scalar>::epsilon()));
    for (std::size_t want = asked_of(part, k);; want = std::min(2 * want, part.ids.size())) {
      std::span<const Found> told = first;
      if (&part != parts_.data() || told.size() != want) {
        s.told.resize(want);
        told = std::span<const Found>(s.told).first(
            part.tree->nearest(q, want, limited, std::span<Found>(s.told), work));
      }
      g.more.clear();
      std::size_t alive = 0;
      for (const Found& f : told) {
        if (f.id == no_id || alive == k) break;
        if (!is_there(part, f.id)) continue;
        ++alive;
        take(f.distance2, part.ids[f.id], [&] { return part.points[f.id]; });
      }
      if (!sound) return false;
      const bool all = told.size() < want || (want > 0 && told.back().id == no_id);
      if (alive == k || all || want == part.ids.size()) break;
    }
    merge();
  }
  g.more.clear();
  work.primitive(loose_.size());
  if (plain && measure_.scale == 1 && !reach.widely) {
    loose_.each_near(q, std::min(worst(), reach.square), [&](Scalar distance2, std::size_t i) {
      take(distance2, loose_.id(i), [&] { return loose_.point(i); });
    });
  } else {
    for (std::size_t i = 0; i < loose_.size(); ++i) {
      const auto square = query.square(loose_.point(i));
      if (reach(square.distance2, square.wide))
        take(measure_.unscaled_square(square.distance2), loose_.id(i), [&] { return loose_.point(i); });
    }
  }
  if (!sound) return false;
  const std::size_t kept = std::min(k, g.more.size());
  std::partial_sort(g.more.begin(), g.more.begin() + static_cast<std::ptrdiff_t>(kept), g.more.end());
  g.more.resize(kept);
  merge();
  return true;
}

/// After gather() into s.ranked, whose worst bounds where the k best are: all that lie there, ranked.
template <NeighborIndex Tree>
template <class W>
void DynamicPoints<Tree>::gather_widely(const Point& q, const Query& query, std::size_t k,
                                        Scalar max_distance, Scratch& s, W& work) const {
  const Reach<Scalar> reach = measure_.reach(max_distance);
  std::vector<Ranked>& best = s.ranked.best;
  Scalar radius = Query::widened(max_distance);
  if (best.size() == k) radius = std::min(radius, query.radius_of(best.back().distance2));
  best.clear();
  const auto take = [&](Id id, const Point& point) {
    const auto square = query.square(point);
    if (reach(square.distance2, square.wide)) best.push_back({query.rank(square), id});
  };
  for (const Part& part : parts_) {
    part.tree->within(q, radius, s.told, work);
    for (const Found& t : s.told)
      if (is_there(part, t.id)) take(part.ids[t.id], part.points[t.id]);
  }
  work.primitive(loose_.size());
  for (std::size_t i = 0; i < loose_.size(); ++i) take(loose_.id(i), loose_.point(i));
  const std::size_t kept = std::min(k, best.size());
  std::partial_sort(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(kept), best.end());
  best.resize(kept);
}

template <NeighborIndex Tree>
template <class W>
std::size_t DynamicPoints<Tree>::find_nearest(const Point& q, const NearestOptions<Scalar>& options,
                                              std::span<const Found> first, std::span<Found> out, Scratch& s,
                                              W& work) const {
  const std::size_t k = out.size();
  if (k == 0) return 0;
  const Query query(measure_, q);
  if (alike_ && gather(q, query, k, options, first, s, s.plain, work)) {
    std::copy(s.plain.best.begin(), s.plain.best.end(), out.begin());
    return s.plain.best.size();
  }
  gather(q, query, k, options, first, s, s.ranked, work);
  if (!alike_) gather_widely(q, query, k, options.max_distance, s, work);
  const std::vector<Ranked>& best = s.ranked.best;
  for (std::size_t i = 0; i < best.size(); ++i) out[i] = {query.told_square(best[i].distance2), best[i].id};
  return best.size();
}

template <NeighborIndex Tree>
template <WorkCounter W>
std::size_t DynamicPoints<Tree>::nearest(const Point& q, std::size_t k, const NearestOptions<Scalar>& options,
                                         std::span<Found> out, W& work) const {
  Checks::check_k(k), Checks::check_options(options), Checks::check_query(q, "query");
  const std::size_t m = std::min(k, size());
  Checks::check_room(out.size(), m);
  Scratch s;
  return find_nearest(q, options, {}, out.first(m), s, work);
}

/// The largest tree answers several queries at once, as its own batches do.
template <NeighborIndex Tree>
void DynamicPoints<Tree>::nearest(std::span<const Point> queries, std::size_t k,
                                  const NearestOptions<Scalar>& options, std::span<Found> out,
                                  int threads) const {
  Checks::check_k(k), Checks::check_options(options), Checks::check_queries(queries);
  Checks::check_rows(out.size(), queries.size(), k);
  const std::size_t m = std::min(k, size());
  parallel_ranges(queries.size(), threads, [&](std::size_t begin, std::size_t end) {
    NoWork work;
    Scratch s;
    const std::size_t want = parts_.empty() || m == 0 ? 0 : asked_of(parts_.front(), m);
    constexpr std::size_t together = 64;
    std::vector<Found> told;
    for (std::size_t from = begin; from < end; from += together) {
      const std::size_t count = std::min(together, end - from);
      if (want > 0) {
        told.resize(want * count);
        parts_.front().tree->nearest(queries.subspan(from, count), want, options, std::span<Found>(told), 1);
      }
      for (std::size_t i = 0; i < count; ++i) {
        const std::span<Found> row = out.subspan((from + i) * k, k);
        const auto first = std::span<const Found>(told).subspan(i * want, want);
        const std::size_t n = find_nearest(queries[from + i], options, first, row.first(m), s, work);
        std::ranges::fill(row.subspan(n), Found{});
      }
    }
  });
}

/// Calls f(found, point) for all within a radius.
template <NeighborIndex Tree>
template <class W, class F>
void DynamicPoints<Tree>::each_within(const Point& q, Scalar radius, W& work, F&& f) const {
  const Query query(measure_, q);
  const Reach<Scalar> reach = measure_.reach(radius);
  const bool direct = alike_ && !reach.widely;
  const auto measure = [&](Id id, const Point& p) {
    const auto square = query.square(p);
    if (reach(square.distance2, square.wide)) f(Found{query.told_square(query.rank(square)), id}, p);
  };
  const Scalar asked = direct || radius == 0 ? radius : Query::widened(radius);  // what is at q is so exactly
  std::vector<Found> told;
  for (const Part& part : parts_) {
    part.tree->within(q, asked, told, work);
    for (const Found& t : told) {
      if (!is_there(part, t.id)) continue;
      if (direct && is_sound(t.distance2))  // else the parts need not tell what all together do
        f(Found{t.distance2, part.ids[t.id]}, part.points[t.id]);
      else
        measure(part.ids[t.id], part.points[t.id]);
    }
  }
  work.primitive(loose_.size());
  if (direct && measure_.scale == 1)
    loose_.each_near(q, reach.square, [&](Scalar distance2, std::size_t i) {
      if (is_sound(distance2))
        f(Found{distance2, loose_.id(i)}, loose_.point(i));
      else
        measure(loose_.id(i), loose_.point(i));
    });
  else
    for (std::size_t i = 0; i < loose_.size(); ++i) measure(loose_.id(i), loose_.point(i));
}

template <NeighborIndex Tree>
template <WorkCounter W>
void DynamicPoints<Tree>::within(const Point& q, Scalar radius, std::vector<Found>& out, W& work) const {
  Checks::check_radius(radius), Checks::check_query(q, "query");
  out.clear();
  each_within(q, radius, work, [&](const Found& f, const Point&) { out.push_back(f); });
}

template <NeighborIndex Tree>
template <WorkCounter W>
void DynamicPoints<Tree>::within(const Point& q, Scalar radius, const WithinOptions& options,
                                 std::vector<Found>& out, W& work) const {
  Checks::check_radius(radius), Checks::check_query(q, "query");
  out.clear();
  if (options.at_most < size()) {
    NearestOptions<Scalar> nearest_options;
    nearest_options.max_distance = radius;
    out.resize(options.at_most);
    Scratch s;
    return out.resize(find_nearest(q, nearest_options, {}, out, s, work));
  }
  if (!options.ranked()) return within(q, radius, out, work);
  const Query query(measure_, q);
  std::vector<Ranked> list;
  each_within(q, radius, work, [&](const Found& f, const Point& p) {
    list.push_back({query.rank(query.square(p)), f.id});
  });
  std::sort(list.begin(), list.end());
  for (const Ranked& r : list) out.push_back({query.told_square(r.distance2), r.id});
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::within_squared(const Point& q, Scalar radius2, std::vector<Found>& out) const {
  Checks::check_radius2(radius2);
  within(q, Measure::radius_over(radius2), out);
  std::erase_if(out, [&](const Found& f) { return f.distance2 > radius2; });
}

template <NeighborIndex Tree>
std::size_t DynamicPoints<Tree>::count_within(const Point& q, Scalar radius) const {
  Checks::check_radius(radius), Checks::check_query(q, "query");
  std::size_t count = 0;
  NoWork work;
  each_within(q, radius, work, [&](const Found&, const Point&) { ++count; });
  return count;
}

template <NeighborIndex Tree>
template <WorkCounter W>
void DynamicPoints<Tree>::inside(const Box& box, std::vector<Id>& out, W& work) const {
  Checks::check_box(box, "box");
  out.clear();
  std::vector<Id> told;
  for (const Part& part : parts_) {
    part.tree->inside(box, told, work);
    for (const Id local : told)
      if (is_there(part, local)) out.push_back(part.ids[local]);
  }
  work.primitive(loose_.size());
  for (std::size_t i = 0; i < loose_.size(); ++i)
    if (box.contains(loose_.point(i))) out.push_back(loose_.id(i));
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::within(std::span<const Point> queries, Scalar radius, Lists<Found>& out,
                                 int threads) const {
  Checks::check_radius(radius), Checks::check_queries(queries);
  parallel_lists(queries.size(), threads, out, [&](std::size_t i, std::vector<Found>& list) {
    NoWork work;
    each_within(queries[i], radius, work, [&](const Found& f, const Point&) { list.push_back(f); });
  });
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::inside(std::span<const Box> boxes, Lists<Id>& out, int threads) const {
  Checks::check_boxes(boxes);
  parallel_lists(boxes.size(), threads, out, [&](std::size_t i, std::vector<Id>& list) {
    std::vector<Id> ids;
    inside(boxes[i], ids);
    list.insert(list.end(), ids.begin(), ids.end());
  });
}

}  // namespace treeline::accel
