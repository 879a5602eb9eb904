// What a tracer has of its scene: surfaces, the camera's rays, the index over the faces and the numbers that
// decide; and which films it renders into.
//
// All tracers of this folder stand on it, and differ in how they carry light alone.
#pragma once

#include <string>

#include "accel/concepts.hpp"
#include "shading/transport/camera_rays.hpp"
#include "shading/transport/film.hpp"
#include "shading/transport/path_points.hpp"
#include "shading/transport/surfaces.hpp"

namespace treeline::shading::transport {

template <accel::RayIndex Index>
class Stage {
 public:
  /// The index, over the scene's mesh, must outlive this. `set`: of Sobol points, samples that share a net.
  /// Throws as Surfaces and CameraRays do.
  Stage(const Index& index, const LitScene& scene, Points points, int set, std::uint64_t seed)
      : index_(&index),
        surfaces_(scene),
        points_(points, set, seed),
        camera_(scene.camera),
        width_(scene.camera.width),
        height_(scene.camera.height),
        set_(points == Points::random ? 1 : set) {}

  const Index& index() const { return *index_; }
  const Surfaces& surfaces() const { return surfaces_; }
  const PathPoints& points() const { return points_; }
  const CameraRays& camera() const { return camera_; }

  /// Without samples: of the camera's size, or of another.
  Film film() const { return film(width_, height_); }
  Film film(int width, int height) const { return Film(width, height, set_); }

  /// Throws InvalidOptions for a film that is not of the camera's size.
  void check_size(const Film& film) const {
    if (film.width() != width_ || film.height() != height_)
      throw InvalidOptions("the film has " + std::to_string(film.width()) + " × " +
                           std::to_string(film.height()) + " pixels, the camera " + std::to_string(width_) +
                           " × " + std::to_string(height_));
  }
  /// As many, of each pixel. Throws InvalidOptions for fewer than none, and a film of other sets.
  std::uint64_t checked_samples(const Film& film, int samples) const {
    if (samples < 0)
      throw InvalidOptions("samples is " + std::to_string(samples) + "; it must not be negative");
    if (film.set() != set_)
      throw InvalidOptions("the film has sets of " + std::to_string(film.set()) + " samples, the options " +
                           std::to_string(set_));
    return static_cast<std::uint64_t>(samples);
  }

 private:
  const Index* index_;
  Surfaces surfaces_;
  PathPoints points_;
  CameraRays camera_;
  int width_, height_, set_;
};

}  // namespace treeline::shading::transport
