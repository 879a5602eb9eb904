// All faces of a scene that emit, as one light.
//
// Problem: light that is carried by sampling its sources needs one point of all of them, and the density it
// was drawn with. Method: a face in proportion to area × luminance, a point evenly over the face. The density
// by area is then luminance / Σ (area × luminance): it does not depend on the face's area, and a constant
// emission is sampled without noise. Faces are found by inverting the sums, which keeps well-spread numbers
// well spread (an alias table would not), from a table of guesses (Chen and Asau 1974). Cost: O(n) to build;
// a sample some ten operations, and on average less than two steps from the guess. Known weakness: where
// emitters are many, most are far or hidden, and still are chosen by power alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/sampling.hpp"
#include "shading/light/invalid_light.hpp"
#include "shading/light/luminance.hpp"
#include "shading/scene.hpp"

namespace treeline::shading::light {

struct EmitterSample {
  std::uint32_t face = 0;    ///< of the scene's mesh
  geometry::Vec3f point{};   ///< on it
  geometry::Vec3f normal{};  ///< unit; light leaves on its side
  Rgb emission{};            ///< radiance there; W / (m² sr)
  float pdf_area = 0;        ///< 1 / m², the choice of the face included
};

/// As Emitters keeps it.
struct EmittingFace {
  geometry::Triangle3f corners;
  geometry::Vec3f normal;
  Rgb emission;
  float pdf_area;
  std::uint32_t face;
};

/// A face alone, drawn by one number of which a part is left to draw from.
struct EmitterChoice {
  std::uint32_t face = 0;
  double probability = 0;
  double rest = 0;  ///< in [0, 1), evenly, whatever the face
};

class Emitters {
 public:
  /// Keeps what it needs of the scene. Faces without area emit nothing. Throws InvalidLight if faces and
  /// their materials do not match, if an emission is negative or not finite, or if an emitting face names a
  /// vertex that is missing or not finite; it names the face and the material.
  explicit Emitters(const LitScene& scene);

  /// True if nothing emits: there is nothing to sample then.
  bool empty() const { return faces_.empty(); }
  std::size_t size() const { return faces_.size(); }

  /// choice, u, v in [0, 1): of the face, of the point on it. Not to be called where empty().
  EmitterSample sample(double choice, float u, float v) const {
    const EmittingFace& f = face_of(choice);
    const geometry::Vec3f w = geometry::sample_triangle(u, v);
    return {f.face, f.corners.a * w[0] + f.corners.b * w[1] + f.corners.c * w[2], f.normal, f.emission,
            f.pdf_area};
  }
  /// The face that sample() takes.
  const EmittingFace& face_of(double choice) const { return faces_[place_of(choice)]; }
  EmitterChoice choose(double choice) const {
    const std::size_t i = place_of(choice);
    const double before = i > 0 ? sums_[i - 1] : 0, probability = sums_[i] - before;
    return {faces_[i].face, probability,
            std::clamp((choice - before) / probability, 0.0, 0x1.fffffffffffffp-1)};
  }

  /// Density at which sample() draws any point of a face of the scene; 0 if the face does not emit. 1 / m².
  float pdf_area(std::uint32_t face) const { return pdf_area_[face]; }

  /// That leaves all faces into their half spaces, by channel; W.
  geometry::Vec3d power() const { return power_; }

 private:
  std::size_t place_of(double choice) const {
    const std::size_t n = faces_.size();
    std::size_t i = guesses_[std::min(n - 1, static_cast<std::size_t>(choice * static_cast<double>(n)))];
    while (i + 1 < n && sums_[i] <= choice) ++i;
    return i;
  }

  std::vector<EmittingFace> faces_;
  std::vector<double> sums_;            // of the probabilities, up to and with each of faces_
  std::vector<std::uint32_t> guesses_;  // the first of faces_ that a choice of i / size() or more may mean
  std::vector<float> pdf_area_;         // for each face of the scene
  geometry::Vec3d power_{};
};

inline Emitters::Emitters(const LitScene& scene) {
  const auto name = [&](std::size_t face) { return "face " + std::to_string(face); };
  if (scene.face_materials.size() != scene.mesh.size())
    throw InvalidLight("the scene has " + std::to_string(scene.mesh.size()) + " faces, but materials for " +
                       std::to_string(scene.face_materials.size()));
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    for (int k = 0; k < 3; ++k)
      if (const float e = scene.materials[m].emission[k]; !(e >= 0 && std::isfinite(e)))
        throw InvalidLight("material " + std::to_string(m) + " '" + scene.materials[m].name + "' emits " +
                           std::to_string(e) + "; radiance must be finite and not negative");

  pdf_area_.assign(scene.mesh.size(), 0.0f);
  double total = 0;
  for (std::size_t i = 0; i < scene.mesh.size(); ++i) {
    const std::uint32_t m = scene.face_materials[i];
    if (m >= scene.materials.size())
      throw InvalidLight(name(i) + " is of material " + std::to_string(m) + " of " +
                         std::to_string(scene.materials.size()));
    const Rgb emission = scene.materials[m].emission;
    const double bright = luminance(geometry::Vec3d(emission));
    if (!(bright > 0)) continue;
    for (const std::uint32_t corner : scene.mesh.faces[i])
      if (corner >= scene.mesh.vertices.size() || !is_finite(scene.mesh.vertices[corner]))
        throw InvalidLight(name(i) + " emits, but its vertex " + std::to_string(corner) +
                           " is missing or not finite");
    const geometry::Triangle3f corners = scene.mesh.triangle(i);
    const geometry::Vec3d normal = geometry::Triangle3d(corners).area_normal();
    const double twice = length(normal);
    if (!(twice > 0)) continue;
    total += 0.5 * twice * bright;
    power_ += geometry::Vec3d(emission) * (0.5 * twice * std::numbers::pi);
    faces_.push_back({corners, geometry::Vec3f(normal / twice), emission, static_cast<float>(bright),
                      static_cast<std::uint32_t>(i)});
    sums_.push_back(total);
  }

  const std::size_t n = faces_.size();
  for (std::size_t i = 0; i < n; ++i) {
    sums_[i] /= total;
    faces_[i].pdf_area = static_cast<float>(faces_[i].pdf_area / total);
    pdf_area_[faces_[i].face] = faces_[i].pdf_area;
  }
  guesses_.resize(n);
  for (std::size_t i = 0, at = 0; i < n; ++i) {
    while (at + 1 < n && sums_[at] <= static_cast<double>(i) / static_cast<double>(n)) ++at;
    guesses_[i] = static_cast<std::uint32_t>(at);
  }
}

}  // namespace treeline::shading::light
