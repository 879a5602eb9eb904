#include "tests/shading/transport_common.hpp"

#include <cmath>
#include <numbers>

#include "accel/bvh.hpp"
#include "shading/transport/path_tracer.hpp"
#include "shading/transport/textbook.hpp"
#include "shading/transport/whitted.hpp"

namespace treeline::test {

using Tree = accel::Bvh<accel::Triangles<>, accel::Wide>;

Material diffuse(float albedo, float emission) {
  Material m;
  m.reflectance = Rgb::filled(albedo), m.emission = Rgb::filled(emission);
  return m;
}
Material mirror(float reflectance) {
  Material m = diffuse(reflectance);
  m.kind = shading::SurfaceKind::mirror;
  return m;
}
Material glass(double index) {
  Material m;
  m.kind = shading::SurfaceKind::glass, m.index = index;
  return m;
}

namespace {
void add_face(LitScene& scene, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto at = static_cast<std::uint32_t>(scene.mesh.vertices.size());
  scene.mesh.vertices.insert(scene.mesh.vertices.end(), {a, b, c});
  scene.mesh.faces.push_back({at, at + 1, at + 2});
  scene.face_materials.push_back(static_cast<std::uint32_t>(scene.materials.size() - 1));
}
}  // namespace

void add_quad(LitScene& scene, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d,
              const Material& m) {
  scene.materials.push_back(m);
  add_face(scene, a, b, c), add_face(scene, a, c, d);
}

void add_box(LitScene& scene, const Vec3f& low, const Vec3f& high, bool outside, const Material& m) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int x = (axis + 1) % 3, y = (axis + 2) % 3;
      Vec3f corner[4];
      for (int i = 0; i < 4; ++i) {
        corner[i][axis] = side ? high[axis] : low[axis];
        corner[i][x] = i == 1 || i == 2 ? high[x] : low[x];
        corner[i][y] = i >= 2 ? high[y] : low[y];
      }
      if ((side == 1) == outside)
        add_quad(scene, corner[0], corner[1], corner[2], corner[3], m);
      else
        add_quad(scene, corner[3], corner[2], corner[1], corner[0], m);
    }
}

void add_ball(LitScene& scene, const Vec3f& centre, float radius, const Material& m) {
  scene.materials.push_back(m);
  constexpr int rows = 16, columns = 32;
  const auto at = [&](int row, int column) {
    const double polar = std::numbers::pi * row / rows, turn = 2 * std::numbers::pi * column / columns;
    return centre +
           Vec3f(Vec3d{std::sin(polar) * std::cos(turn), std::cos(polar), -std::sin(polar) * std::sin(turn)} *
                 double(radius));
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vec3f a = at(row, column), b = at(row + 1, column), c = at(row + 1, column + 1),
                  d = at(row, column + 1);
      if (row > 0) add_face(scene, a, c, d);
      if (row + 1 < rows) add_face(scene, a, b, c);
    }
}

LitScene furnace(float albedo) {
  LitScene scene;
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, false, diffuse(albedo, 1 - albedo));
  scene.camera = {.position = {0, 0, 0.9}, .target = {0, 0, 0}, .width = 16, .height = 12};
  return scene;
}

LitScene lamp_room() {
  LitScene scene;
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, false, diffuse(0.7f));
  scene.materials.push_back(diffuse(0.3f)), scene.materials.push_back(diffuse(0.5f));
  const auto n = static_cast<std::uint32_t>(scene.materials.size());
  scene.face_materials[0] = scene.face_materials[1] = n - 2;  // the wall x = -1
  scene.face_materials[2] = scene.face_materials[3] = n - 1;  // x = 1
  add_quad(scene, {-0.3f, 0.95f, -0.3f}, {0.3f, 0.95f, -0.3f}, {0.3f, 0.95f, 0.3f}, {-0.3f, 0.95f, 0.3f},
           diffuse(0, 8));
  add_box(scene, {-0.5f, -1, -0.6f}, {0.1f, -0.2f, 0}, true, diffuse(0.6f));
  scene.camera = {
      .position = {0, 0, 0.95}, .target = {0, 0, 0}, .height_angle = 1.2, .width = 24, .height = 16};
  return scene;
}

void trace(const LitScene& scene, const transport::PathOptions& options, transport::Film& film, int samples,
           int threads, const Source& source, std::uint64_t* rays) {
  const Tree tree(scene.mesh);
  const transport::PathTracer<Tree> tracer(tree, scene, options);
  const transport::RayCounts counts =
      source ? tracer.render(film, samples, threads, source) : tracer.render(film, samples, threads);
  if (rays) *rays = counts.rays + counts.shadow_rays;
}

void trace_textbook(const LitScene& scene, const transport::TextbookOptions& options, transport::Film& film,
                    int samples, int threads, const Source& source) {
  const Tree tree(scene.mesh);
  const transport::Textbook<Tree> tracer(tree, scene, options);
  source ? tracer.render(film, samples, threads, source) : tracer.render(film, samples, threads);
}

transport::WhittedCounts trace_whitted(const LitScene& scene, const transport::WhittedOptions& options,
                                       transport::Film& film, int samples, int threads,
                                       const Source& source) {
  const Tree tree(scene.mesh);
  const transport::Whitted<Tree> tracer(tree, scene, options);
  return source ? tracer.render(film, samples, threads, source) : tracer.render(film, samples, threads);
}

transport::Film traced(const LitScene& scene, const transport::PathOptions& options, int samples,
                       int threads) {
  transport::Film film(scene.camera.width, scene.camera.height,
                       options.points == transport::Points::random ? 1 : options.set);
  trace(scene, options, film, samples, threads);
  return film;
}

Estimate overall(const transport::Film& film, int channel) {
  double mean = 0, variance = 0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    const double e = film.standard_error(i)[channel];
    mean += film.mean(i)[channel], variance += e * e;
  }
  const double n = static_cast<double>(film.size());
  return {mean / n, std::sqrt(variance) / n};
}

}  // namespace treeline::test
