#include "bench/knn_nd/task.hpp"

#include "bench/knn_nd/block.hpp"
#include "bench/knn_nd/truth.hpp"
#include "datasets_gen/hard/hard_rows.hpp"
#include "geometry/random.hpp"

namespace treeline::bench::knn_nd {
namespace {

using datasets::Vectors;

std::size_t queries_a_set(Profile profile) {
  switch (profile) {
    case Profile::smoke:
      return 50;
    case Profile::quick:
      return 150;  // recall over 10 neighbours in steps below a thousandth; all blocks in under a minute
    case Profile::full:
      return 1000;
  }
  throw std::invalid_argument("no such profile");
}

Questions questions_for(Profile profile) {
  Questions q;
  q.sets = {{"knn1", 1}, {"knn10", 10}};
  if (profile != Profile::quick) q.sets.push_back({"knn100", 100});
  return q;
}

/// Takes the last `count` rows off.
Vectors cut_off(Vectors& v, std::size_t count) {
  Vectors r;
  r.columns = v.columns;
  const auto from = v.scalars.end() - static_cast<std::ptrdiff_t>(count * v.columns);
  r.scalars.assign(from, v.scalars.end());
  v.scalars.erase(from, v.scalars.end());
  return r;
}

/// Takes a random tenth of the finite rows off, but at most `count`. The others stay in order.
Vectors hold_out(Vectors& v, std::size_t count, std::uint64_t seed) {
  geometry::Pcg32 random(seed, 7);  // a stream of its own, apart from the recipes'
  std::vector<std::uint32_t> finite;
  for (std::size_t i = 0; i < v.size(); ++i)
    if (is_finite(v.row(i))) finite.push_back(static_cast<std::uint32_t>(i));
  count = std::min(count, finite.size() / 10);
  if (count == 0)
    throw std::invalid_argument(
        (finite.size() == 1 ? "1 finite row is" : std::to_string(finite.size()) + " finite rows are") +
        std::string(" too few: a tenth of them is held out as queries"));
  std::vector<bool> taken(v.size());
  Vectors queries, rest;
  queries.columns = rest.columns = v.columns;
  const auto append = [&](Vectors& to, std::size_t i) {
    to.scalars.insert(to.scalars.end(), v.row(i).begin(), v.row(i).end());
  };
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(finite[i], finite[i + random.below(static_cast<std::uint32_t>(finite.size() - i))]);
    taken[finite[i]] = true;
    append(queries, finite[i]);
  }
  for (std::size_t i = 0; i < v.size(); ++i)
    if (!taken[i]) append(rest, i);
  v = std::move(rest);
  return queries;
}

Vectors rows_of(const std::vector<geometry::Vec3f>& points) {
  Vectors r;
  r.columns = 3;
  for (const auto& p : points) r.scalars.insert(r.scalars.end(), {p[0], p[1], p[2]});
  return r;
}

}  // namespace

KnnNdTask::KnnNdTask() : RegisteredTask(TREELINE_TASK_METHODS, TREELINE_TASK_NOT_BUILT) {}

std::vector<BlockSpec> KnnNdTask::blocks(Profile profile) const {
  std::vector<BlockSpec> r;
  switch (profile) {
    case Profile::smoke:
      return {{"descriptors_32", 2'000}, {"uniform_8", 1'000}};
    case Profile::quick:
      return {{"descriptors_8", 10'000},
              {"descriptors_32", 20'000},
              {"descriptors_128", 10'000},
              {"uniform_32", 10'000}};
    case Profile::full:
      for (const std::size_t n : {10'000u, 100'000u})
        for (const datasets::Recipe& recipe : datasets::recipes())
          if (recipe.kind == datasets::Kind::vectors) r.push_back({recipe.name, n});
      r.push_back({"descriptors_32", 1'000'000});
      return r;
  }
  throw std::invalid_argument("no such profile");
}

std::vector<BlockSpec> KnnNdTask::hard_blocks() const {
  std::vector<BlockSpec> r;
  for (const datasets::HardRows& c : datasets::hard_rows()) r.push_back({c.name, c.rows.size(), true});
  return r;
}

std::unique_ptr<Block> KnnNdTask::open(const BlockSpec& spec, const RunContext& context) const {
  if (!spec.hard) {
    // More rows than asked for, the last ones being the queries.
    const std::size_t count = queries_a_set(context.profile);
    datasets::Dataset d = datasets::generate(spec.dataset, spec.n + count, context.seed);
    if (d.kind != datasets::Kind::vectors)
      throw std::invalid_argument("dataset '" + spec.dataset + "' does not consist of vectors");
    Questions questions = questions_for(context.profile);
    questions.rows = cut_off(d.vectors, count);
    return open_block(registered(), std::move(d), std::move(questions), version(), context);
  }
  for (datasets::HardRows& c : datasets::hard_rows()) {
    if (c.name != spec.dataset) continue;
    datasets::Dataset d;
    d.kind = datasets::Kind::vectors, d.seed = context.seed, d.vectors = std::move(c.rows);
    Questions questions;
    questions.sets = {{"knn" + std::to_string(c.k), c.k}};
    questions.rows = std::move(c.queries);
    questions.hard = true, questions.must_answer = c.expect == datasets::Expect::answers;
    return open_block(registered(), std::move(d), std::move(questions), version(), context);
  }
  throw std::invalid_argument("no hard case for rows is called '" + spec.dataset + "'");
}

std::unique_ptr<Block> KnnNdTask::open(datasets::Dataset dataset, const RunContext& context) const {
  if (dataset.kind != datasets::Kind::vectors) {
    dataset.vectors =
        rows_of(dataset.kind == datasets::Kind::cloud ? dataset.cloud.points : dataset.mesh.vertices);
    dataset.kind = datasets::Kind::vectors, dataset.cloud = {}, dataset.mesh = {};
  }
  Questions questions = questions_for(context.profile);
  questions.rows = hold_out(dataset.vectors, queries_a_set(context.profile), context.seed);
  return open_block(registered(), std::move(dataset), std::move(questions), version(), context);
}

}  // namespace treeline::bench::knn_nd
