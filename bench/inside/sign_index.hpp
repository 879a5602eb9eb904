// Our trees and rules as methods: one adapter for all of them.
#pragma once

#include "accel/signed_distance/signed_distance.hpp"
#include "bench/core/registry.hpp"
#include "bench/inside/method.hpp"

namespace treeline::bench::inside {

template <class Tree, class Sign>
class SignIndex final : public Index {
 public:
  using Body = accel::SignedDistance<Tree, Sign>;
  /// node_bytes: of an inner node of the tree; 0 where the claims ledger does not speak of it.
  explicit SignIndex(Body body, std::size_t node_bytes = 0)
      : body_(std::move(body)), node_bytes_(node_bytes) {}

  void inside(std::span<const geometry::Vec3f> points, std::span<std::uint8_t> out, const Knobs&,
              int threads) const override {
    body_.inside(points, out, threads);
  }
  Knobs facts() const override {
    Knobs out = Knobs::object();
    if constexpr (requires { body_.tree().stats(); })
      if (node_bytes_ > 0)
        out = {{"inside_references", body_.tree().stats().references}, {"inside_node_bytes", node_bytes_}};
    return out;
  }

 private:
  Body body_;
  std::size_t node_bytes_;
};

/// A user's mesh may hold a broken triangle; dropping it keeps the rest usable.
template <class Tree>
typename Tree::Options tree_options(int threads) {
  typename Tree::Options options;
  options.non_finite = accel::NonFinite::drop;
  if constexpr (requires { options.threads; }) options.threads = threads;
  return options;
}

template <class Tree, class Sign>
std::unique_ptr<Index> build_sign(const geometry::Mesh3f& mesh, const typename Sign::Options& options,
                                  int threads, std::size_t node_bytes = 0) {
  using Of = SignIndex<Tree, Sign>;
  return std::make_unique<Of>(typename Of::Body(mesh, tree_options<Tree>(threads), options, threads),
                              node_bytes);
}

/// Registers a tree with a rule that has no options.
template <class Tree, class Sign>
bool register_sign(MethodInfo info, std::size_t node_bytes = 0) {
  return Registry<Method>::instance().add(
      {.info = std::move(info),
       .build = [node_bytes](const geometry::Mesh3f& mesh, const Knobs&,
                             int threads) { return build_sign<Tree, Sign>(mesh, {}, threads, node_bytes); },
       .by_facing = std::is_same_v<Sign, accel::FirstHit>});
}

using WideTree = accel::Bvh<accel::Triangles<float>, accel::Wide>;

}  // namespace treeline::bench::inside
