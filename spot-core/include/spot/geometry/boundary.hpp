// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "spot/base/vector.hpp"
#include "spot/geometry/solid.hpp"
#include "spot/geometry/wall_contact.hpp"

namespace spot {

class Curve;

/// The surface of a solid, as grains inside and straight paths meet it: its faces, edges and corners. Distances are
/// those to what is left of each face where solids are united and intersected.
///
/// Distances to faces, straight and circular edges, and corners are exact but for rounding; to other edges (edges.hpp),
/// and to corners on them, within 1e-8 of `size`. Everything is found when it is made, so any number of threads may
/// ask.
class Boundary {
 public:
  /// `size` is a length that no radius and no thickness is much below. Surfaces closer than 1e-9 of it are the same, so
  /// that shapes that touch have no gap between them. Throws InvalidContainer if two are closer than 1e-4 of it but not
  /// the same, if there are more than 64 different ones, and where edges cannot be found (edges.hpp).
  Boundary(const Solid& solid, double size);
  ~Boundary();
  Boundary(Boundary&&) noexcept;

  /// With the surface itself.
  bool contains(const Vector3& place) const;

  /// Adds every point of the surface, within `reach` of a place and in sight of it, that is nearer than all others
  /// around it. From outside, the nearest point alone, its distance negative.
  void add_contacts(const Vector3& place, double reach, WallContacts& contacts) const;

  /// The nearest of these.
  std::optional<WallContact> nearest(const Vector3& place, double reach) const;

  /// Where a path leaves the solid, or where it begins if that is outside; then without a normal, unless it begins on
  /// the surface.
  std::optional<WallOnPath> first_wall(const Vector3& from, const Vector3& to) const;

 private:
  /// On which side of each surface a place is, a bit each; on both where it is on the surface.
  struct Sides {
    std::uint64_t inner = 0, outer = 0;
    void add(std::size_t surface, bool is_inner);
    void set(std::size_t surface, bool is_inner);
  };
  /// A union or an intersection of sides of surfaces, and of other nodes.
  struct Node {
    bool unites;
    Sides sides;
    std::vector<Node> parts;
  };
  static constexpr std::size_t most_surfaces = 64;
  /// Of a place, in each surface.
  using Depths = std::array<double, most_surfaces>;
  struct Edge {
    std::size_t first, second;
    std::unique_ptr<Curve> curve;
  };
  struct Corner {
    std::size_t first, second;
    Vector3 point;
  };
  struct Candidate {
    Vector3 point;
    double distance;
    bool on_face;
  };

  Node node_of(const Solid& solid);
  void add_part(Node& node, const Solid& part);
  std::size_t number_of(const std::shared_ptr<const Surface>& surface);
  void find_edges();
  void find_corners();

  Depths depths_at(const Vector3& place) const;
  Sides sides_of(const Depths& depths) const;
  Sides sides_of(const Vector3& place) const;
  static bool matches(const Node& node, const Sides& sides);
  bool changes_across(std::size_t surface, Sides sides) const;
  bool is_inside_to(double distance, const Depths& depths) const;
  bool lies_on(const Vector3& point, std::size_t first, std::size_t second) const;
  std::vector<Candidate> candidates(const Vector3& place, double reach, const Depths& depths) const;
  template <typename Visit>
  void visit_contacts(const Vector3& place, double reach, Visit&& visit) const;
  bool is_minimum(const Vector3& place, const Candidate& candidate) const;
  bool falls_along(const Vector3& place, const Vector3& point, std::size_t surface,
                   const std::vector<std::size_t>& through, bool& on_boundary) const;
  bool in_sight(const Vector3& place, const Candidate& candidate) const;
  WallContact contact(const Vector3& place, const Vector3& point, bool inside) const;
  Vector3 normal_of_wall(const Vector3& point, const Vector3& along) const;

  double tolerance_;  ///< places closer than this are the same (length)
  double probe_;      ///< how far around a point its surroundings are looked at (length)
  std::vector<std::shared_ptr<const Surface>> surfaces_;
  Node whole_{};
  std::vector<Edge> edges_;
  std::vector<Corner> corners_;
};

}  // namespace spot
