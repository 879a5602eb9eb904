// Builds the BSP tree of a solid from the convex polygons that bound it: an autopartition, with help along
// axes.
//
// A node takes a plane, keeps the pieces that lie in it (a list; a face is never cut by its own plane) and
// passes the others on, cut where they cross it. A side that nothing is left for is a leaf: behind its faces
// it is inside the solid, in front outside. That needs a surface that does not cross itself: faces that run
// through each other are refused, exactly, as they meet; pairs that meet along a line in the plane of a third
// that is taken first, along edges, or flush, are left to parts.hpp. Planes across an axis are taken only
// where both sides have pieces, so that a face always tells. Sources: Fuchs, Kedem and Naylor 1980; Thibault
// and Naylor 1987. Sets wait on a stack of their own: no depth overflows the machine's. Cost: O(pieces ·
// depth).
#pragma once

#include "accel/bsp_solid/choose_plane.hpp"

namespace treeline::accel {

/// The mesh bounds no solid: it is open, not oriented or inside out, or meets, crosses or encloses itself.
struct NotASolid : InvalidInput {
  using InvalidInput::InvalidInput;
};

}  // namespace treeline::accel

namespace treeline::accel::solid {

struct Node {
  static constexpr std::uint32_t inside = 0xffffffffu, outside = 0xfffffffeu;
  static bool is_leaf(std::uint32_t link) { return link >= outside; }

  PlaneId plane;
  std::uint32_t child[2];      // behind, in front
  std::uint32_t first, count;  // its pieces
};

struct SolidTree {
  std::vector<Node> nodes;
  std::vector<Piece> pieces;  // in the planes of nodes
  std::uint32_t root = Node::outside;
  std::size_t depth = 0, leaves = 0, inside_leaves = 0, contradictions = 0;
};

template <class Space>
class SolidBuilder {
 public:
  /// names: of the faces, for messages.
  SolidBuilder(Pieces<Space>& pieces, std::span<const Id> names, const SolidOptions& options)
      : pieces_(pieces), names_(names), choose_(pieces, options), may_cross_(options.may_cross_itself) {}

  SolidTree operator()(std::vector<Piece> source) {
    if (source.empty()) return std::move(tree_);
    std::vector<Set> waiting;
    waiting.push_back({std::move(source), no_parent, 0, 0});
    while (!waiting.empty()) {
      Set set = std::move(waiting.back());
      waiting.pop_back();
      const auto number = static_cast<std::uint32_t>(tree_.nodes.size());
      link(set) = number;
      tree_.depth = std::max(tree_.depth, static_cast<std::size_t>(set.level) + 1);
      Node node{choose_(set.pieces, set.level), {}, static_cast<std::uint32_t>(tree_.pieces.size()), 0};
      Set part[2] = {{{}, number, 0, set.level + 1}, {{}, number, 1, set.level + 1}};
      divide(set.pieces, node.plane, part[0].pieces, part[1].pieces);
      node.count = static_cast<std::uint32_t>(tree_.pieces.size()) - node.first;
      if (Space::is_exact && !may_cross_) refuse_crossings(node);
      for (std::uint32_t side = 0; side < 2; ++side)
        if (part[side].pieces.empty()) node.child[side] = leaf(node, side);
      tree_.nodes.push_back(node);
      for (Set& s : part)
        if (!s.pieces.empty()) waiting.push_back(std::move(s));
    }
    return std::move(tree_);
  }

 private:
  static constexpr std::uint32_t no_parent = 0xffffffffu;
  struct Set {
    std::vector<Piece> pieces;
    std::uint32_t parent, side;
    int level;
  };

  std::string name(const Piece& p) const { return std::to_string(names_[p.face]); }
  std::uint32_t& link(const Set& s) {
    return s.parent == no_parent ? tree_.root : tree_.nodes[s.parent].child[s.side];
  }
  void divide(const std::vector<Piece>& set, PlaneId plane, std::vector<Piece>& back,
              std::vector<Piece>& front) {
    using Side = typename Pieces<Space>::Side;
    cut_.clear();
    for (const Piece& p : set) switch (pieces_.side(plane, p)) {
        case Side::on:
          tree_.pieces.push_back(p);
          break;
        case Side::front:
          front.push_back(p);
          break;
        case Side::back:
          back.push_back(p);
          break;
        case Side::both: {
          const auto [before, behind] = pieces_.cut(plane, p);
          front.push_back(before), back.push_back(behind), cut_.push_back(before);
        }
      }
  }
  /// Two faces that run through each other are found where the plane of one cuts the other: neither has been
  /// cut along the line where they meet.
  void refuse_crossings(const Node& node) {
    if constexpr (Space::is_exact)
      for (const Piece& part : cut_)
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          const Piece there = tree_.pieces[i];
          if (pieces_.run_through(node.plane, part, there))
            throw NotASolid("solid: faces " + name(there) + " and " + name(part) + " run through each other");
        }
  }
  std::uint32_t leaf(const Node& node, std::uint32_t side) {
    const Piece& p = tree_.pieces[node.first];
    for (std::uint32_t i = 1; i < node.count; ++i) {
      const Piece& q = tree_.pieces[node.first + i];
      if (p.flip == q.flip) continue;
      if (Space::is_exact)
        throw NotASolid("solid: one cell is inside of face " + name(p.flip == side ? p : q) +
                        " and outside of face " + name(p.flip == side ? q : p) +
                        ", which lie in one plane: the surface meets or crosses itself");
      ++tree_.contradictions;
    }
    ++tree_.leaves;
    const bool inside = (side == 0) != bool(p.flip);
    tree_.inside_leaves += inside;
    return inside ? Node::inside : Node::outside;
  }

  Pieces<Space>& pieces_;
  std::span<const Id> names_;
  PlaneChooser<Space> choose_;
  bool may_cross_;
  std::vector<Piece> cut_;  // by the node at hand: what is in front
  SolidTree tree_;
};

}  // namespace treeline::accel::solid
