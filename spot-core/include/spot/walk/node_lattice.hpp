// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/geometry/container.hpp"
#include "spot/parallel/communicator.hpp"

namespace spot {

/// The cubic lattice on which spots and their steps are counted, shared out between the eight nodes around each in
/// proportion to its nearness to them along each axis, in whole 2^-24ths: sums are the same on any ranks.
///
/// One node is the centre of the first outlet. Where space repeats, so does the lattice: its spacing along that axis is
/// the least from the one asked for on of which the period is a multiple.
class NodeLattice {
 public:
  using Node = std::array<int, 3>;
  struct Corner {
    Node node;
    std::int64_t weight;  ///< in 2^-24ths
  };
  static constexpr std::int64_t whole = 1 << 24;  ///< the weights of a place's corners, together

  /// The container must outlive the lattice, or be replaced.
  NodeLattice(const Container& container, double spacing);

  std::array<Corner, 8> corners(const Vector3& point) const;
  const Vector3& spacing() const { return spacing_; }
  /// Where it is along an axis, in spacings from the node at 0.
  double cell_of(const Vector3& point, std::size_t axis) const {
    const auto i = static_cast<int>(axis);
    return (point[i] - origin_[i]) / spacing_[i];
  }
  /// The place of a node.
  Vector3 point(const Node& node) const { return origin_ + spacing_.cwiseProduct(Vector3(node[0], node[1], node[2])); }
  /// Its image in the cell.
  Node wrapped(Node node) const;

  /// Inside the walls, of the lattice cell around a node, each place counted by its nearness to the node (length^3).
  double volume(const Node& node) const;
  /// That of a cell away from all walls.
  double cell_volume() const { return spacing_.prod(); }

  /// Works out volumes anew, as after walls changed.
  void replace_container(const Container& container);

  /// Nodes from low to high, exclusive, along each axis.
  struct Box {
    Node low = {0, 0, 0}, high = {0, 0, 0};

    bool contains(const Node& node) const;
    std::size_t size() const;
    std::size_t place(const Node& node) const;
    bool operator==(const Box& other) const { return low == other.low && high == other.high; }
    /// The least box around both, of which one may be empty.
    Box united(const Box& other) const;
    /// Values at the nodes of this box as those of a larger one, which has `otherwise` at the others.
    std::vector<double> values_in(const Box& larger, const std::vector<double>& values, double otherwise) const;
    /// Calls visit(node, place) for all of them.
    template <typename Visit>
    void visit(const Visit& visit) const {
      std::size_t place = 0;
      Node node;
      for (node[2] = low[2]; node[2] < high[2]; ++node[2])
        for (node[1] = low[1]; node[1] < high[1]; ++node[1])
          for (node[0] = low[0]; node[0] < high[0]; ++node[0]) visit(node, place++);
    }
  };

  /// Collective. The least box with the lower corners of all points that ranks bring, and one node more along each
  /// axis; all nodes of a period where space repeats. Empty if there are no points.
  Box around(const std::vector<Vector3>& points, Communicator& communicator) const;

  std::size_t memory() const { return volumes_.size() * sizeof(std::pair<const Node, double>); }

 private:
  const Container* container_;
  Vector3 origin_, spacing_;
  Node period_ = {0, 0, 0};                 // in nodes; 0 where nothing repeats
  mutable std::map<Node, double> volumes_;  // of the nodes asked for so far
};

inline void append(Bytes& bytes, const NodeLattice::Box& box) {
  append(bytes, box.low);
  append(bytes, box.high);
}

/// Throws InvalidState if it is damaged.
NodeLattice::Box take_box(ByteReader& saved);

}  // namespace spot
