// Union, intersection and difference of two solids on one grid.
//
// Method: the polygons of each go down the tree of the other, cut at its planes, to the leaves; a piece stays
// if the result is outside on one side of it and inside on the other, and a polygon whose pieces all stay the
// same way stays whole. A tree is then built over what stays. Pieces that lie in a face of the other solid go
// down both sides of its plane and learn what is in front of them and behind; where both solids have the same
// face, the first's stays. Sources: Thibault and Naylor 1987; Naylor, Amanatides and Thibault 1990, who merge
// the two trees themselves: a new one costs about as much and is no deeper than its own faces make it.
// Nothing is rounded: the planes of the result are planes of the two. Cost: pieces times depth, and the
// build. Known weakness: polygons of any kind are cut by planes far from where the surfaces meet, before most
// are put together again.
#pragma once

#include "accel/bsp_solid/tree.hpp"

namespace treeline::accel {

enum class Merge { unite, intersect, subtract };

namespace solid {

class Merger {
 public:
  using Tree = BspTree<Solid<ExactSpace>>;
  using Polygons = Pieces<ExactSpace>;

  Merger(const Tree& a, const Tree& b, Merge operation) : operation_(operation), result_(a.grid()) {
    if (!(a.grid() == b.grid())) throw InvalidInput("solid: the two solids are not on one grid");
    PlaneMap to_a(a.pieces().space, result_.space), to_b(b.pieces().space, result_.space);
    clip(a, to_a, b, to_b, true, 0);
    clip(b, to_b, a, to_a, false, a.size());
  }
  Tree tree(const SolidOptions& options) && {
    return Tree(std::move(result_), std::move(kept_), std::move(names_), options);
  }

 private:
  using Facing = ExactSpace::Facing;

  /// Numbers of one space's planes in another.
  class PlaneMap {
   public:
    PlaneMap(const ExactSpace& from, ExactSpace& to)
        : from_(from), to_(to), known_(from.planes.size(), {no_plane, false}) {}
    Facing operator()(PlaneId id) {
      Facing& f = known_[id];
      if (f.plane == no_plane) f = to_.add(from_.planes[id]);
      return f;
    }
    PlaneId id(PlaneId p) { return p == no_plane ? no_plane : (*this)(p).plane; }

   private:
    const ExactSpace& from_;
    ExactSpace& to_;
    std::vector<Facing> known_;
  };
  struct Task {
    Piece piece;
    std::uint32_t node;
    enum { both, front, back } looking;  // for what the other solid is on which side of the piece
    std::uint32_t then;                  // looking in front: where to look at the back
    bool front_inside;
  };

  void clip(const Tree& tree, PlaneMap& own, const Tree& other, PlaneMap& others, bool first,
            std::size_t offset) {
    std::vector<Task> tasks;
    std::vector<std::pair<Piece, int>> parts;  // with 1 to keep, -1 to keep turned, 0 to drop
    for (const Piece& source : tree.source()) {
      const Piece whole = copy(tree, source, own);
      parts.clear();
      tasks.push_back({whole, other.root(), Task::both, 0, false});
      while (!tasks.empty()) {
        Task t = tasks.back();
        tasks.pop_back();
        for (;;) {
          if (Node::is_leaf(t.node)) {
            if (t.looking != Task::front) break;
            t.looking = Task::back, t.front_inside = t.node == Node::inside, t.node = t.then;
            continue;
          }
          const auto& node = other.nodes()[t.node];
          const Facing plane = others(node.plane);
          const std::uint32_t child[2] = {node.child[plane.flip], node.child[!plane.flip]};
          using Side = Polygons::Side;
          switch (result_.side(plane.plane, t.piece)) {
            case Side::front:
              t.node = child[1];
              break;
            case Side::back:
              t.node = child[0];
              break;
            case Side::on:
              t.looking = Task::front, t.node = child[!t.piece.flip], t.then = child[t.piece.flip];
              break;
            case Side::both: {
              const auto [front, back] = result_.cut(plane.plane, t.piece);
              tasks.push_back({back, child[0], t.looking, t.then, t.front_inside});
              t.piece = front, t.node = child[1];
            }
          }
        }
        const bool behind = t.node == Node::inside,
                   before = t.looking == Task::back ? t.front_inside : behind;
        parts.push_back({t.piece, verdict(first, before, behind)});
      }
      const bool same =
          std::all_of(parts.begin(), parts.end(), [&](const auto& p) { return p.second == parts[0].second; });
      if (same) parts = {{whole, parts[0].second}};
      for (const auto& [piece, keep] : parts)
        if (keep != 0) put(piece, keep < 0, static_cast<Id>(offset + source.face));
    }
  }

  /// What the result is on either side of a face, given what the other solid is there.
  int verdict(bool first, bool before, bool behind) const {
    if (!first && before != behind) return 0;  // the first solid has this face too
    const auto result = [&](bool own, bool other) {
      const bool a = first ? own : other, b = first ? other : own;
      switch (operation_) {
        case Merge::unite:
          return a || b;
        case Merge::intersect:
          return a && b;
        default:
          return a && !b;
      }
    };
    const bool in_front = result(false, before), at_back = result(true, behind);
    return in_front == at_back ? 0 : at_back ? 1 : -1;
  }

  Piece copy(const Tree& tree, const Piece& p, PlaneMap& map) {
    const Facing plane = map(p.plane);
    Piece r{plane.plane, 0, static_cast<std::uint32_t>(result_.corners.size()), p.count,
            p.flip != plane.flip};
    for (auto c : tree.pieces().of(p)) {
      for (auto& id : c.planes) id = map.id(id);
      c.also = map.id(c.also), c.edge = map.id(c.edge), c.twin = map.id(c.twin);
      result_.corners.push_back(c);
    }
    return r;
  }
  void put(Piece piece, bool turn, Id name) {
    piece.face = static_cast<Id>(kept_.size());
    if (turn) {
      // Each edge now leaves from its other end.
      piece.flip = !piece.flip;
      const auto c = result_.of(piece);
      std::reverse(c.begin(), c.end());
      const auto edge = c.front().edge, twin = c.front().twin;
      for (std::size_t i = 0; i + 1 < c.size(); ++i) c[i].edge = c[i + 1].edge, c[i].twin = c[i + 1].twin;
      c.back().edge = edge, c.back().twin = twin;
    }
    kept_.push_back(piece), names_.push_back(name);
  }

  Merge operation_;
  Polygons result_;
  std::vector<Piece> kept_;
  std::vector<Id> names_;
};

}  // namespace solid

/// Faces of the result are named by those of a, then those of b with a.size() added.
inline BspTree<Solid<>> merged(const BspTree<Solid<>>& a, const BspTree<Solid<>>& b, Merge operation,
                               const SolidOptions& options = {}) {
  return solid::Merger(a, b, operation).tree(options);
}

}  // namespace treeline::accel
