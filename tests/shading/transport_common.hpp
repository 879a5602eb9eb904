// What the tests of light transport share: small rooms, and the path tracer compiled once.
#pragma once

#include <functional>

#include "geometry/ray.hpp"
#include "shading/scene.hpp"
#include "shading/transport/film.hpp"
#include "shading/transport/options.hpp"

namespace treeline::test {

using geometry::Vec3d, geometry::Vec3f;
using shading::LitScene, shading::Material, shading::Rgb;
namespace transport = shading::transport;

Material diffuse(float albedo, float emission = 0);
Material mirror(float reflectance);
Material glass(double index);

/// Adds the quadrilateral a b c d, whose front is seen with its corners counterclockwise.
void add_quad(LitScene& scene, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d,
              const Material& m);
/// Adds a box: its fronts outside, or inside.
void add_box(LitScene& scene, const Vec3f& low, const Vec3f& high, bool outside, const Material& m);
void add_ball(LitScene& scene, const Vec3f& centre, float radius, const Material& m);

/// [-1, 1]³ seen from its middle, all of one albedo and emitting the rest: radiance is 1 everywhere.
LitScene furnace(float albedo);
/// A closed box with walls of three albedos, a lamp below its ceiling and a block on its floor.
LitScene lamp_room();

using Source = std::function<geometry::Rayf(std::size_t pixel, float u, float v)>;

/// Path tracing over the wide tree: adds samples to the film, and gives rays and shadow rays in `rays`.
void trace(const LitScene& scene, const transport::PathOptions& options, transport::Film& film, int samples,
           int threads = 1, const Source& source = {}, std::uint64_t* rays = nullptr);
/// A new film, of 1 sample a set or the options' sets.
transport::Film traced(const LitScene& scene, const transport::PathOptions& options, int samples,
                       int threads = 1);

/// The same for the others; one sample a set.
void trace_textbook(const LitScene& scene, const transport::TextbookOptions& options, transport::Film& film,
                    int samples, int threads = 1, const Source& source = {});
transport::WhittedCounts trace_whitted(const LitScene& scene, const transport::WhittedOptions& options,
                                       transport::Film& film, int samples, int threads = 1,
                                       const Source& source = {});

/// Of all pixels: mean of one channel, and its standard error.
struct Estimate {
  double mean, error;
};
Estimate overall(const transport::Film& film, int channel = 0);

}  // namespace treeline::test
