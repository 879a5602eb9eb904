// Queries of DynamicPoints: every tree and the loose points are asked, and what they find is merged.
//
// The trees' squared distances are those of the caller's units, in which they may vanish or overflow though
// each tree ranks its own points right. Where one has lost digits, all are compared by squares of the same
// roundings that have a wider range, so that ranks across trees are those of one tree.
#pragma once

#include "accel/dynamic_points.hpp"

namespace treeline::accel {

// ---- distances -----------------------------------------------------------------------------------------

/// A squared distance as if the scalar had no least and no largest: as a tree computes it that scales its
/// points well. `distance2` is what the scalar says.
template <NeighborIndex Tree>
auto DynamicPoints<Tree>::square(Scalar distance2, const Point& p, const Point& q) -> Square {
  if (is_sound(distance2)) return distance2;
  Scalar largest = 0;
  for (int a = 0; a < dimension; ++a) largest = std::max({largest, std::abs(p[a]), std::abs(q[a])});
  const int down = largest > 1 ? 2 : 0;  // differences of large coordinates may overflow
  Scalar offsets[dimension], widest = 0;
  for (int a = 0; a < dimension; ++a) {
    offsets[a] = std::ldexp(p[a], -down) - std::ldexp(q[a], -down);
    widest = std::max(widest, std::abs(offsets[a]));
  }
  if (widest == 0) return 0;
  const int exponent = std::ilogb(widest);
  for (Scalar& offset : offsets) offset = std::ldexp(offset, -exponent);
  return std::ldexp(static_cast<Square>(squared_length<Scalar, dimension>(offsets)), 2 * (exponent + down));
}

/// What a tree would tell: rounded once, where the scalar loses digits.
template <NeighborIndex Tree>
auto DynamicPoints<Tree>::told_distance2(Scalar distance2, const Point& p, const Point& q) -> Scalar {
  if (is_sound(distance2)) return distance2;
  const Square s = square(distance2, p, q);
  return s <= static_cast<Square>(std::numeric_limits<Scalar>::max())
             ? static_cast<Scalar>(s)
             : std::numeric_limits<Scalar>::infinity();
}

template <NeighborIndex Tree>
bool DynamicPoints<Tree>::reaches(Scalar radius, Scalar distance2, const Point& p, const Point& q) {
  const Scalar limit = radius * radius;
  if (is_sound(limit)) return distance2 <= limit;
  return std::isinf(radius) ||
         square(distance2, p, q) <= static_cast<Square>(radius) * static_cast<Square>(radius);
}

// ---- queries -------------------------------------------------------------------------------------------

/// What is removed takes places, so more than k are asked for.
template <NeighborIndex Tree>
std::size_t DynamicPoints<Tree>::asked_of(const Part& part, std::size_t k) const {
  const std::size_t n = part.ids.size();
  if (part.dead == 0 || k >= n) return std::min(k, n);
  const double share = static_cast<double>(part.dead) / static_cast<double>(n);
  return std::min(n, k + static_cast<std::size_t>(2 * share * static_cast<double>(k)) + 1);
}

/// Into g.best, nearest first. Found items are as good as Ranked ones while all squared distances are sound;
/// returns false once one is not. `first`: what the largest tree has told, if it was asked.
template <NeighborIndex Tree>
template <class Item, class W>
bool DynamicPoints<Tree>::gather(const Point& q, std::size_t k, const NearestOptions<Scalar>& options,
                                 std::span<const Found> first, Scratch& s, Gathered<Item>& g, W& work) const {
  bool sound = true;
  const auto item = [&](Scalar distance2, Id id, const auto& point) -> Item {
    if constexpr (std::is_same_v<Item, Found>) {
      sound = sound && (is_sound(distance2) || (distance2 == 0 && point() == q));
      return {distance2, id};
    } else {
      return {is_sound(distance2) ? Square(distance2) : square(distance2, point(), q), {distance2, id}};
    }
  };
  const auto worst = [&] {  // or infinite
    const bool known = g.best.size() == k && is_sound(found(g.best.back()).distance2);
    return known ? found(g.best.back()).distance2 : std::numeric_limits<Scalar>::infinity();
  };
  const auto merge = [&] {
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
    if (const Scalar w = worst(); w <= std::numeric_limits<Scalar>::max())  // by a margin for rounding
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
      for (const Found& f : told) {
        if (f.id == no_id || g.more.size() == k) break;
        if (is_there(part, f.id))
          g.more.push_back(item(f.distance2, part.ids[f.id], [&] { return part.points[f.id]; }));
      }
      if (!sound) return false;
      const bool all = told.size() < want || (want > 0 && told.back().id == no_id);
      if (g.more.size() == k || all || want == part.ids.size()) break;
    }
    merge();
  }
  g.more.clear();
  work.primitive(loose_.size());
  loose_.each_near(q, worst(), [&](Scalar distance2, std::size_t i) {
    const auto point = [&] { return loose_.point(i); };
    if (std::isinf(options.max_distance) || reaches(options.max_distance, distance2, point(), q))
      g.more.push_back(item(told_distance2(distance2, point(), q), loose_.id(i), point));
  });
  if (!sound) return false;
  const std::size_t kept = std::min(k, g.more.size());
  std::partial_sort(g.more.begin(), g.more.begin() + static_cast<std::ptrdiff_t>(kept), g.more.end());
  g.more.resize(kept);
  merge();
  return true;
}

template <NeighborIndex Tree>
template <class W>
std::size_t DynamicPoints<Tree>::find_nearest(const Point& q, const NearestOptions<Scalar>& options,
                                              std::span<const Found> first, std::span<Found> out, Scratch& s,
                                              W& work) const {
  if (out.empty()) return 0;
  if (gather(q, out.size(), options, first, s, s.plain, work)) {
    std::copy(s.plain.best.begin(), s.plain.best.end(), out.begin());
    return s.plain.best.size();
  }
  gather(q, out.size(), options, first, s, s.ranked, work);
  for (std::size_t i = 0; i < s.ranked.best.size(); ++i) out[i] = s.ranked.best[i].found;
  return s.ranked.best.size();
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
  std::vector<Found> told;
  for (const Part& part : parts_) {
    part.tree->within(q, radius, told, work);
    for (const Found& t : told)
      if (is_there(part, t.id)) f(Found{t.distance2, part.ids[t.id]}, part.points[t.id]);
  }
  work.primitive(loose_.size());
  const Scalar limit = radius * radius;
  loose_.each_near(q, is_sound(limit) ? limit : std::numeric_limits<Scalar>::infinity(),
                   [&](Scalar distance2, std::size_t i) {
                     const Point p = loose_.point(i);
                     if (reaches(radius, distance2, p, q))
                       f(Found{told_distance2(distance2, p, q), loose_.id(i)}, p);
                   });
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
  if (!options.sorted) return within(q, radius, out, work);
  std::vector<Ranked> list;
  each_within(q, radius, work, [&](const Found& f, const Point& p) {
    list.push_back({square(f.distance2, p, q), f});
  });
  std::sort(list.begin(), list.end());
  for (const Ranked& r : list) out.push_back(r.found);
}

template <NeighborIndex Tree>
void DynamicPoints<Tree>::within_squared(const Point& q, Scalar radius2, std::vector<Found>& out) const {
  Checks::check_radius2(radius2);
  within(q, std::nextafter(std::sqrt(radius2), std::numeric_limits<Scalar>::infinity()), out);
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
