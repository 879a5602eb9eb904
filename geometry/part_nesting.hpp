// Which closed parts of a mesh look the wrong way for where they lie: outward within a solid, or inward in
// the open.
//
// Problem: a part turned inside out, or a solid within a solid, leaves a mesh closed and oriented. Method:
// the winding number of all other parts around a part is 0 where that must look outward, 1 where inward. A
// part says nothing about points out of its box: a tree over the boxes tells whose to ask; these are asked
// through the column above the point, exactly (exact/column_grid.hpp). Cost: O(n log n), and a column for
// each box that a part's point lies in. Known weakness: parts nested k deep are k² such columns; a part all
// of whose points tried lie on others is not judged.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/box_tree.hpp"
#include "geometry/exact/column_grid.hpp"

namespace treeline::geometry {

class PartNesting {
 public:
  struct Part {
    std::vector<std::uint32_t> faces;
    double volume = 0;  ///< signed, in any unit; NaN: of no meaning
    bool whole = true;  ///< all its corners are finite; else it says nothing of points in its box
  };

  /// Each part has faces; these are finite and, but for parts that are not whole, together closed and
  /// oriented. The mesh and the parts must outlive this.
  PartNesting(const Mesh3f& mesh, std::span<const Part> parts)
      : mesh_(mesh), parts_(parts), columns_(parts.size()) {
    std::vector<Box3d> boxes(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (const std::uint32_t f : parts[i].faces) boxes[i].grow(Triangle3d(mesh.triangle(f)).box());
    tree_ = BoxTree<double>(boxes);
  }

  /// False where nothing tells, too.
  bool looks_the_wrong_way(std::size_t part) {
    constexpr std::size_t most_tries = 8;  // points of a part, where one lies on another part
    const Part& p = parts_[part];
    for (std::size_t k = 0; k < std::min(most_tries, p.faces.size()); ++k) {
      const Triangle3d face(mesh_.triangle(p.faces[k]));
      // A little into what the part itself goes around: another part's face may lie flush.
      constexpr double share = 0x1p-20;
      const Vec3d normal = face.area_normal();
      const double longest2 =
          std::max({length2(face.b - face.a), length2(face.c - face.b), length2(face.a - face.c)});
      if (!(length2(normal) > 0)) continue;
      const Vec3d at = face.centroid() - normal * (std::copysign(share, p.volume) / std::sqrt(longest2));
      const std::optional<int> around = winding_of_others(part, at);
      if (around) return (p.volume > 0 && *around != 0) || (p.volume < 0 && *around != 1);
    }
    return false;
  }
  /// Looked at so far.
  std::size_t boxes() const { return looked_at_; }

 private:
  /// None for a point on one of them, or in the box of one that is not whole.
  std::optional<int> winding_of_others(std::size_t part, const Vec3d& at) {
    int winding = 0;
    bool clear = true;
    tree_.each([&](const Box3d& box) { return ++looked_at_, box.contains(at); },
               [&](std::uint32_t other) {
                 if (other == part || !clear) return;
                 clear = parts_[other].whole;
                 if (!clear) return;
                 auto& columns = columns_[other];
                 if (!columns) columns.emplace(mesh_, parts_[other].faces);
                 const Enclosure found = (*columns)(at);
                 clear = !found.on_surface, winding += found.winding;
               });
    return clear ? std::optional(winding) : std::nullopt;
  }

  const Mesh3f& mesh_;
  std::span<const Part> parts_;
  BoxTree<double> tree_;                            // over the parts' boxes
  std::vector<std::optional<ColumnGrid>> columns_;  // of each part, once it is asked
  std::size_t looked_at_ = 0;
};

}  // namespace treeline::geometry
