// The same maps, bit for bit, on every instruction set: compiled once for each, and compared by digest.
#include <cstdio>
#include <string_view>

#include "../accel/instruction_set.hpp"
#include "geometry/random.hpp"
#include "raster_common.hpp"

namespace treeline::shading::raster::test {
namespace {

std::uint64_t digest_of(const DepthMap& map) {
  std::uint64_t hash = 0;
  for (const auto* layer : {&map.first, &map.second})
    for (const float depth : *layer) {
      std::uint32_t bits;
      std::memcpy(&bits, &depth, sizeof bits);
      hash = geometry::hash_u64(hash, bits);
    }
  return hash;
}

std::uint64_t digest() {
  std::uint64_t hash = 1;
  const auto add = [&](const Mesh3f& mesh, const LightView& view) {
    for (const int side : {61, 500})
      for (const int layers : {1, 2})
        hash = geometry::hash_u64(hash,
                                  digest_of(draw(mesh, view, side, {.layers = layers, .threads = layers})));
  };
  for (const bool perspective : {false, true}) {
    for (const std::string& name : datasets::scene_names())
      for (const std::size_t n : {1000u, 30'000u}) {
        const Mesh3f mesh = datasets::make_scene(name, n, 1).mesh;
        add(mesh, view_of(mesh, perspective));
      }
    // From near by: much is clipped.
    const Mesh3f mesh = datasets::make_scene("city", 3000, 1).mesh;
    LightView near = view_of(mesh, perspective);
    near.near = 0.5 * (near.near + near.far), near.half_width *= 0.01, near.half_height *= 0.01;
    add(mesh, near);
  }
  return hash;
}

}  // namespace
}  // namespace treeline::shading::raster::test

int main(int argc, char** argv) {
  using namespace treeline;
  if (argc != 2 || std::string_view(argv[1]) != "--digest") return 2;
  if (accel::test::runs_here())
    std::printf("%016llx\n", static_cast<unsigned long long>(shading::raster::test::digest()));
  return 0;
}
