// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <typeinfo>

#include "geometry/curve.hpp"
#include "geometry/directions.hpp"
#include "geometry/edges.hpp"

namespace spot {

namespace {

/// Surfaces that cross a small region, of which all combinations of sides are tried.
constexpr int most_tried = 4;

/// The largest difference between the numbers of two surfaces (length).
double difference(const Surface& a, const Surface& b, double size) {
  if (typeid(a) != typeid(b)) return size;
  const auto of_a = a.numbers(size), of_b = b.numbers(size);
  double largest = 0.0;
  for (std::size_t k = 0; k < of_a.size(); ++k) largest = std::max(largest, std::abs(of_a[k] - of_b[k]));
  return largest;
}

/// Directions in a plane, given by two that are across each other.
constexpr int directions_around = 8;

}  // namespace

void Boundary::Sides::add(std::size_t surface, bool is_inner) {
  (is_inner ? inner : outer) |= std::uint64_t{1} << surface;
}

void Boundary::Sides::set(std::size_t surface, bool is_inner) {
  const std::uint64_t bit = std::uint64_t{1} << surface;
  inner = is_inner ? inner | bit : inner & ~bit;
  outer = is_inner ? outer & ~bit : outer | bit;
}

Boundary::Boundary(const Solid& solid, double size) : tolerance_(1e-9 * size), probe_(1e-5 * size) {
  require_positive(size, "the size of a container");
  whole_ = node_of(solid);
  find_edges();
  find_corners();
}

Boundary::~Boundary() = default;
Boundary::Boundary(Boundary&&) noexcept = default;

Boundary::Node Boundary::node_of(const Solid& solid) {
  Node node{solid.kind() == Solid::Kind::union_of, {}, {}};
  add_part(node, solid);
  return node;
}

/// Sides that are parts of one node are kept as bits, and so are those of a part that is united or intersected as the
/// node itself is.
void Boundary::add_part(Node& node, const Solid& part) {
  if (part.kind() == Solid::Kind::side)
    node.sides.add(number_of(part.surface()), part.inner());
  else if ((part.kind() == Solid::Kind::union_of) == node.unites)
    for (const Solid& inner : part.parts()) add_part(node, inner);
  else
    node.parts.push_back(node_of(part));
}

std::size_t Boundary::number_of(const std::shared_ptr<const Surface>& surface) {
  const double clear = 1e5 * tolerance_;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    const double apart = difference(*surfaces_[k], *surface, 1e9 * tolerance_);
    if (apart < tolerance_) return k;
    if (apart < clear)
      throw InvalidContainer(message("two surfaces of a container are ", apart, " apart: make them the same, to ",
                                     tolerance_, ", or differ by at least ", clear));
  }
  if (surfaces_.size() == most_surfaces)
    throw InvalidContainer(message("a container has more than ", most_surfaces, " different surfaces"));
  surfaces_.push_back(surface);
  return surfaces_.size() - 1;
}

void Boundary::find_edges() {
  for (std::size_t i = 0; i < surfaces_.size(); ++i)
    for (std::size_t j = i + 1; j < surfaces_.size(); ++j)
      for (auto& curve : edges_between(*surfaces_[i], *surfaces_[j], tolerance_))
        edges_.push_back({i, j, std::move(curve)});
}

void Boundary::find_corners() {
  for (std::size_t k = 0; k < surfaces_.size(); ++k)
    if (const auto apex = surfaces_[k]->apex()) corners_.push_back({k, k, *apex});
  for (const Edge& edge : edges_)
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      if (k == edge.first || k == edge.second) continue;
      for (const Vector3& point : edge.curve->meetings(*surfaces_[k], tolerance_))
        if (lies_on(point, edge.first, edge.second)) corners_.push_back({edge.first, edge.second, point});
    }
}

Boundary::Depths Boundary::depths_at(const Vector3& place) const {
  Depths depths;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) depths[k] = surfaces_[k]->depth(place);
  return depths;
}

Boundary::Sides Boundary::sides_of(const Depths& depths) const {
  Sides sides;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (depths[k] >= 0.0) sides.inner |= std::uint64_t{1} << k;
    if (depths[k] <= 0.0) sides.outer |= std::uint64_t{1} << k;
  }
  return sides;
}

Boundary::Sides Boundary::sides_of(const Vector3& place) const { return sides_of(depths_at(place)); }

bool Boundary::matches(const Node& node, const Sides& sides) {
  const std::uint64_t inner = sides.inner & node.sides.inner, outer = sides.outer & node.sides.outer;
  if (node.unites) {
    if ((inner | outer) != 0) return true;
  } else if (inner != node.sides.inner || outer != node.sides.outer) {
    return false;
  }
  for (const Node& part : node.parts)
    if (matches(part, sides) == node.unites) return node.unites;
  return !node.unites;
}

bool Boundary::contains(const Vector3& place) const { return place.allFinite() && matches(whole_, sides_of(place)); }

/// Is one side of this surface inside and the other outside, at a point with these sides of the others?
bool Boundary::changes_across(std::size_t surface, Sides sides) const {
  sides.outer &= ~sides.inner;  // where only the surface itself is inside there is no room
  sides.set(surface, true);
  const bool inner = matches(whole_, sides);
  sides.set(surface, false);
  return inner != matches(whole_, sides);
}

bool Boundary::lies_on(const Vector3& point, std::size_t first, std::size_t second) const {
  return std::abs(surfaces_[first]->depth(point)) < tolerance_ &&
         std::abs(surfaces_[second]->depth(point)) < tolerance_;
}

/// Is all inside that is no farther than this from a place with these depths? True only where no surface that comes as
/// close is a wall, on whichever sides of the others; most of them are none there, as a pipe below an outlet is none
/// above it.
bool Boundary::is_inside_to(double distance, const Depths& depths) const {
  std::uint64_t near = 0;
  int count = 0;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (std::abs(depths[k]) > distance + tolerance_) continue;
    near |= std::uint64_t{1} << k;
    if (++count > most_tried) return false;
  }
  Sides sides = sides_of(depths);
  // Whatever is inside though it is on neither side of these, is on both.
  sides.inner &= ~near;
  sides.outer &= ~near;
  if (matches(whole_, sides)) return true;
  for (std::uint64_t inner = near;; inner = (inner - 1) & near) {
    sides.inner = (sides.inner & ~near) | inner;
    sides.outer = (sides.outer & ~near) | (near & ~inner);
    if (!matches(whole_, sides)) return false;
    if (inner == 0) return true;
  }
}

std::optional<WallOnPath> Boundary::first_wall(const Vector3& from, const Vector3& to) const {
  const Vector3 along = to - from;
  const double length = along.norm();
  if (!(length > 0.0)) return std::nullopt;
  if (is_inside_to(length, depths_at(from))) return std::nullopt;
  const double gap = 1e-3 * tolerance_ / length;  // between crossings that are one
  std::array<double, 2 * most_surfaces + 1> shares;
  std::size_t n = 0;
  for (const auto& surface : surfaces_)
    for (const double share : Crossings(surface->along({from, along})))
      if (share > 0.0 && share < 1.0) shares[n++] = share;
  std::sort(shares.begin(), shares.begin() + n);
  shares[n] = 1.0;
  double begin = 0.0;
  for (std::size_t k = 0; k <= n; ++k) {
    if (shares[k] - begin > gap && !matches(whole_, sides_of(from + 0.5 * (begin + shares[k]) * along)))
      return WallOnPath{begin, normal_of_wall(from + begin * along, along)};
    begin = shares[k];
  }
  if (contains(to)) return std::nullopt;
  // It ends on a wall, or just behind.
  const double share = n > 0 && shares[n - 1] > 1.0 - gap ? shares[n - 1] : 1.0;
  return WallOnPath{share, normal_of_wall(from + share * along, along)};
}

/// Against the path that leaves here; zero where there is no surface.
Vector3 Boundary::normal_of_wall(const Vector3& point, const Vector3& along) const {
  const Sides sides = sides_of(point);
  Vector3 found = Vector3::Zero();
  double most = -1.0;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (std::abs(surfaces_[k]->depth(point)) > tolerance_) continue;
    const Vector3 normal = surfaces_[k]->normal(point);
    const double against = std::abs(normal.dot(along)) / along.norm() + (changes_across(k, sides) ? 2.0 : 0.0);
    if (against <= most) continue;
    most = against;
    found = normal.dot(along) > 0.0 ? Vector3(-normal) : normal;
  }
  return found;
}

/// All that may be nearest, nearest first.
std::vector<Boundary::Candidate> Boundary::candidates(const Vector3& place, double reach, const Depths& depths) const {
  std::vector<Candidate> found;
  std::array<bool, most_surfaces> near{};
  const auto add = [&](const Vector3& point, bool on_face) {
    const double distance = (point - place).norm();
    if (distance < reach) found.push_back({point, distance, on_face});
  };
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    near[k] = std::abs(depths[k]) < reach;
    if (near[k]) add(surfaces_[k]->nearest(place), true);
  }
  if (found.empty()) return found;
  for (const Edge& edge : edges_)
    if (near[edge.first] && near[edge.second])
      edge.curve->visit_nearest(place, reach, [&](const Vector3& point) {
        if (lies_on(point, edge.first, edge.second)) add(point, false);
      });
  for (const Corner& corner : corners_)
    if (near[corner.first] && near[corner.second]) add(corner.point, false);
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  return found;
}

template <typename Visit>
void Boundary::visit_contacts(const Vector3& place, double reach, Visit&& visit) const {
  const Depths depths = depths_at(place);
  if (is_inside_to(reach, depths)) return;
  const std::vector<Candidate> near = candidates(place, reach, depths);
  if (near.empty()) return;
  const bool inside = place.allFinite() && matches(whole_, sides_of(depths));
  std::vector<Candidate> taken;
  for (const Candidate& candidate : near) {
    // One and the same point is found more than once where a face or an edge ends.
    const double apart = 2.0 * probe_ + 1e-3 * candidate.distance;
    const bool known = std::any_of(taken.begin(), taken.end(), [&](const Candidate& other) {
      return (other.point - candidate.point).norm() < apart;
    });
    if (known || !is_minimum(place, candidate)) continue;
    if (inside && !taken.empty() && !in_sight(place, candidate)) continue;  // nothing is before the nearest
    visit(contact(place, candidate.point, inside));
    if (!inside) return;
    taken.push_back(candidate);
  }
}

/// Does the surface of the solid go through here, and is no other point of it around here nearer to the place?
bool Boundary::is_minimum(const Vector3& place, const Candidate& candidate) const {
  const Depths depths = depths_at(candidate.point);
  std::vector<std::size_t> through;
  for (std::size_t k = 0; k < surfaces_.size(); ++k)
    if (std::abs(depths[k]) < tolerance_) through.push_back(k);
  if (through.size() == 1 && candidate.on_face) return changes_across(through.front(), sides_of(depths));
  bool on_boundary = false;
  for (const std::size_t surface : through)
    if (falls_along(place, candidate.point, surface, through, on_boundary)) return false;
  return on_boundary;
}

/// Is there, close to a point of a surface and on that surface, a point of the boundary that is nearer to the place?
bool Boundary::falls_along(const Vector3& place, const Vector3& point, std::size_t surface,
                           const std::vector<std::size_t>& through, bool& on_boundary) const {
  constexpr double asides[] = {1e-3, 3e-2};  // beside an edge, so that it is on one face; more where faces are tangent
  const double least = 1e-4 * probe_;        // by which it has to be nearer, above rounding
  const Vector3 normal = surfaces_[surface]->normal(point), to_place = place - point;
  const double distance = to_place.norm();
  const auto falls = [&](const Vector3& direction) {
    const Vector3 probe = surfaces_[surface]->nearest(point + probe_ * direction);
    if (!changes_across(surface, sides_of(probe))) return false;
    on_boundary = true;
    return (probe - place).norm() < distance - least;
  };
  const Vector3 down = to_place - normal.dot(to_place) * normal;
  if (down.norm() > 1e-12 * distance && falls(down.normalized())) return true;
  for (const std::size_t other : through) {
    const Vector3 edge = normal.cross(surfaces_[other]->normal(point));
    if (edge.norm() < 1e-6) continue;
    const Vector3 direction = edge.normalized(), beside = normal.cross(direction);
    for (const double aside : asides)
      for (const Vector3& around_it : {Vector3(direction + aside * beside), Vector3(direction - aside * beside)})
        if (falls(around_it) || falls(-around_it)) return true;
  }
  const Vector3 first = across(normal), second = normal.cross(first);
  for (int k = 0; k < directions_around; ++k) {
    if (falls(around(static_cast<double>(k) / directions_around, first, second))) return true;
  }
  return false;
}

bool Boundary::in_sight(const Vector3& place, const Candidate& candidate) const {
  if (candidate.distance <= 2.0 * probe_) return true;
  const double share = 1.0 - probe_ / candidate.distance;
  return !first_wall(place, place + share * (candidate.point - place));
}

WallContact Boundary::contact(const Vector3& place, const Vector3& point, bool inside) const {
  const Vector3 from_wall = inside ? Vector3(place - point) : Vector3(point - place);
  const double distance = from_wall.norm();
  if (distance > tolerance_) return {inside ? distance : -distance, from_wall / distance};
  // On the surface: away from all faces here.
  const Sides sides = sides_of(point);
  Vector3 normal = Vector3::Zero();
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (std::abs(surfaces_[k]->depth(point)) > tolerance_ || !changes_across(k, sides)) continue;
    Sides inner = sides;
    inner.set(k, true);
    normal += (matches(whole_, inner) ? 1.0 : -1.0) * surfaces_[k]->normal(point);
  }
  const double norm = normal.norm();
  return {inside ? distance : -distance, norm > 0.0 ? Vector3(normal / norm) : Vector3(0.0, 0.0, 1.0)};
}

void Boundary::add_contacts(const Vector3& place, double reach, WallContacts& contacts) const {
  visit_contacts(place, reach, [&](const WallContact& contact) { contacts.add(contact); });
}

std::optional<WallContact> Boundary::nearest(const Vector3& place, double reach) const {
  std::optional<WallContact> nearest;
  visit_contacts(place, reach, [&](const WallContact& contact) {
    if (!nearest) nearest = contact;
  });
  return nearest;
}

}  // namespace spot
