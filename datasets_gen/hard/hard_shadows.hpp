// Hard cases for shadows: a small scene, and where there is one, its shadow by a formula. As hard_case.hpp.
#pragma once

#include "datasets_gen/hard/hard_case.hpp"
#include "shading/scene.hpp"

namespace treeline::datasets {

/// A blocker that ends in a straight line and nowhere else in sight: what closed forms know of a scene. A
/// strip is one less another.
struct HalfPlane {
  geometry::Vec3d point;  ///< of its edge
  geometry::Vec3d along;  ///< the edge's direction
  geometry::Vec3d into;   ///< from the edge into the blocker
  double sign = 1;        ///< −1: what it takes counts back
};

/// All that casts shadows on a scene's receivers; how what they take of the light adds up.
struct Blockers {
  std::vector<HalfPlane> planes;
  bool nested = false;  ///< each lies behind the next, seen from anywhere: only the largest counts

  bool empty() const { return planes.empty(); }
};

/// Receivers on a straight line, evenly spread from one end to the other, both included.
struct ReceiverLine {
  /// edge: across a penumbra, from dark to lit; contact: from the foot of a blocker into its shadow; leak: in
  /// full shadow, where edges of blockers lie above; top: in full light, on a caster.
  std::string name;
  geometry::Vec3d from, to, normal{0, 1, 0};
  std::size_t count = 2001;
};

/// What is known of a scene, by its name (scenes/scene.hpp), besides its mesh.
struct KnownShadows {
  Blockers blockers;     ///< empty: not known
  bool all_lit = false;  ///< nothing casts a shadow on what the camera sees
  std::vector<ReceiverLine> lines;
};
KnownShadows known_shadows(const std::string& scene);

/// Whether it is the scene of this name, with or without knobs.
bool is_scene_of(const std::string& scene, const std::string& name);
/// The numbers after the scene's name, or the defaults of those left out; of a name that make_scene takes.
std::vector<double> scene_knobs(const std::string& scene, const std::string& name);

struct HardShadow {
  std::string name;  ///< unique, over all other hard cases too
  std::string source, law;
  Expect expect = Expect::answers;
  shading::Scene scene;
  KnownShadows known;
  int frames = 0;  ///< in which the light moves; 0: it does not
};

/// Deterministic.
std::vector<HardShadow> hard_shadows();

}  // namespace treeline::datasets
