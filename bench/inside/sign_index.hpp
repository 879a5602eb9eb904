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
  explicit SignIndex(Body body) : body_(std::move(body)) {}

  void inside(std::span<const geometry::Vec3f> points, std::span<std::uint8_t> out, const Knobs&,
              int threads) const override {
    body_.inside(points, out, threads);
  }

 private:
  Body body_;
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
                                  int threads) {
  using Of = SignIndex<Tree, Sign>;
  return std::make_unique<Of>(typename Of::Body(mesh, tree_options<Tree>(threads), options, threads));
}

/// Registers a tree with a rule that has no options.
template <class Tree, class Sign>
bool register_sign(MethodInfo info) {
  return Registry<Method>::instance().add(
      {.info = std::move(info), .build = [](const geometry::Mesh3f& mesh, const Knobs&, int threads) {
         return build_sign<Tree, Sign>(mesh, {}, threads);
       }});
}

using WideTree = accel::Bvh<accel::Triangles<float>, accel::Wide>;

}  // namespace treeline::bench::inside
