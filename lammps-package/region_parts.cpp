// SPDX-License-Identifier: GPL-2.0-only
#include "lammps_headers.h"

#include "region_parts.h"

#include "domain.h"
#include "region.h"
#include "spot/base/errors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

using spot::Vector3;

namespace LAMMPS_NS {

namespace {

/// Part `i` of a union or intersection: since 2022 they hold pointers to their parts, before that numbers of regions.
template <typename AnyRegion, typename AnyDomain>
auto part(AnyRegion &region, AnyDomain &, int i, int) -> decltype(region.reglist[i]) {
  return region.reglist[i];
}

template <typename AnyRegion, typename AnyDomain>
auto part(AnyRegion &region, AnyDomain &domain, int i, long) -> decltype(domain.regions[region.list[i]]) {
  return domain.regions[region.list[i]];
}

bool is_inside(Region &shape, const Vector3 &at) { return shape.inside(at.x(), at.y(), at.z()) != 0; }

/// Calls visit(vector from the wall to the place) for the faces of a shape within reach, seen from inside or outside.
template <typename Visit>
void visit_faces(Region &shape, bool inside, const Vector3 &at, double reach, Visit &&visit) {
  double place[3] = {at.x(), at.y(), at.z()};
  const int n = inside ? shape.surface_interior(place, reach) : shape.surface_exterior(place, reach);
  for (int i = 0; i < n; ++i) visit(Vector3(shape.contact[i].delx, shape.contact[i].dely, shape.contact[i].delz));
}

/// Around the places of a cone that are nearest to some far away, along both ways of all axes; empty if it has none.
Eigen::AlignedBox3d box_from_outside(Region &cone) {
  constexpr double far = 1e6;
  Eigen::AlignedBox3d box;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-far, far}) {
      Vector3 from(1.0, 0.8, 0.6);  // on the axis of no cone
      from[axis] = side;
      bool found = false;
      visit_faces(cone, false, from, 4.0 * far, [&](const Vector3 &from_wall) {
        found = true;
        box.extend(from - from_wall);
      });
      if (!found) return {};
    }
  return box;
}

/// Where a radius of a cone is 0, Region::surface_exterior finds nothing, or the opposite base from wherever one looks,
/// at one and the same height.
bool has_point(Region &cone) {
  const Eigen::AlignedBox3d box = box_from_outside(cone);
  return box.isEmpty() || box.sizes().minCoeff() < 1e-8;
}

/// The flat ends of a cone along y are reported along z by Region::surface_interior: behind its surface a cone goes on.
bool misplaces_ends(Region &cone) {
  Eigen::AlignedBox3d box(Vector3(cone.extent_xlo, cone.extent_ylo, cone.extent_zlo),
                          Vector3(cone.extent_xhi, cone.extent_yhi, cone.extent_zhi));
  if (!cone.bboxflag) box = box_from_outside(cone);
  const double height = box.sizes().y();
  for (const double share : {1e-3, 1.0 - 1e-3}) {
    Vector3 at = box.center() + Vector3(1e-6 * height, 0.0, 0.0);
    at.y() = box.min().y() + share * height;
    bool wrong = false;
    visit_faces(cone, true, at, 2e-3 * height,
                [&](const Vector3 &from_wall) { wrong = wrong || is_inside(cone, at - 1.01 * from_wall); });
    if (wrong) return true;
  }
  return false;
}

}  // namespace

std::string way_to_write_mouth(const spot::Orifice &orifice) {
  const Vector3 &c = orifice.centre;
  return spot::message("as the union of a closed shape and a pipe that leads out of it, 'region pipe cylinder z ",
                       c.x(), ' ', c.y(), ' ', orifice.radius, ' ', c.z() - 2.0 * orifice.radius, ' ',
                       c.z() + 1e-3 * orifice.radius, "'");
}

RegionParts::RegionParts(Region *region, Domain &domain, const spot::Orifice &orifice)
    : tolerance_(1e-7 * orifice.radius), whole_(part_of(region, domain)) {
  require_closed(whole_, orifice);
  require_known_surface(whole_, false);
}

RegionParts::Part RegionParts::part_of(Region *region, Domain &domain) {
  const std::string style = region->style;
  Part made{region, style == "union", {}, shapes_.size()};
  if (style == "union" || style == "intersect") {
    for (int i = 0; i < region->nregion; ++i) made.parts.push_back(part_of(part(*region, domain, i, 0), domain));
    return made;
  }
  constexpr std::array<const char *, 7> convex = {"block", "cone", "cylinder", "ellipsoid", "plane", "prism", "sphere"};
  if (std::find(convex.begin(), convex.end(), style) == convex.end())
    throw spot::InvalidContainer(spot::message("region '", region->id, "' is of style ", style,
                                               ", which is not supported, as no mesh is: write it as block, cone, "
                                               "cylinder, ellipsoid, plane, prism, sphere, and union and intersect of "
                                               "them, round parts as cones and cylinders, flat ones as planes"));
  shapes_.push_back(region);
  return made;
}

void RegionParts::require_closed(const Part &part, const spot::Orifice &orifice) const {
  const bool composed = !whole_.parts.empty();
  if (part.region->openflag && (composed || !part.region->interior))
    throw spot::InvalidContainer(spot::message(
        "region '", part.region->id, "', a part of '", whole_.region->id,
        "', has an open face, and LAMMPS can't tell what is inside ", composed ? "a union or intersection" : "a shape",
        composed ? " of such parts" : " with 'side out'", ": write it without 'open', ", way_to_write_mouth(orifice)));
  for (const Part &inner : part.parts) require_closed(inner, orifice);
}

void RegionParts::require_known_surface(const Part &part, bool obstacle) const {
  obstacle = obstacle != (part.region->interior == 0);
  const bool is_cone = std::string(part.region->style) == "cone";
  // The other parts of a union or intersection see it from outside.
  if (is_cone && (obstacle || !whole_.parts.empty()) && has_point(*part.region))
    throw spot::InvalidContainer(spot::message("region '", part.region->id,
                                               "' is a cone with a point, whose surface LAMMPS does not find from "
                                               "outside: give its end a small radius instead of 0"));
  if (is_cone && !obstacle && misplaces_ends(*part.region))
    throw spot::InvalidContainer(
        spot::message("region '", part.region->id,
                      "' is a cone along y, whose ends LAMMPS does not find: use one along x or "
                      "z, or open them"));
  for (const Part &inner : part.parts) require_known_surface(inner, obstacle);
}

/// The share of the path up to the place where it enters a convex shape, both of its ends being outside; above 1 if it
/// does not. The plane through the nearest point of the shape, across the line to it, has all of the shape behind it,
/// so one may go as far as that plane.
double RegionParts::entrance(Region &shape, const Vector3 &from, const Vector3 &to) const {
  constexpr int rounds = 200;
  constexpr double never = 2.0;
  const double length = (to - from).norm();
  const Vector3 along = (to - from) / length;
  // LAMMPS knows no way from a place on the axis of a shape to its surface.
  const Vector3 aside = 1e-2 * tolerance_ * Vector3(1.0, 0.8, 0.6);
  double gone = 0.0;
  for (int round = 0; round < rounds; ++round) {
    const Vector3 at = from + gone * along + aside;
    if (is_inside(shape, at)) break;
    Vector3 away = Vector3::Zero();
    bool found = false;
    visit_faces(shape, false, at, length - gone + tolerance_, [&](const Vector3 &from_wall) {
      away = from_wall;
      found = true;
    });
    if (!found) return never;
    const double distance = away.norm(), nearer = -away.dot(along) / distance;
    if (nearer <= 0.0) return never;
    if (distance <= tolerance_) break;
    // Not all the way: behind a plate without thickness one would look away from it.
    gone += (distance - 0.5 * tolerance_) / nearer;
    if (gone > length) return never;
  }
  return gone / length;
}

RegionParts::Stay RegionParts::stay(Region &shape, const Vector3 &from, const Vector3 &to) const {
  const bool begins = is_inside(shape, from), ends = is_inside(shape, to);
  if (begins && ends) return {0.0, 1.0};
  if (!begins && !ends) {
    const double enters = entrance(shape, from, to);
    // A path that touches has no place inside: seen from the other end it may miss.
    return {enters, enters > 1.0 ? 0.0 : std::max(enters, 1.0 - entrance(shape, to, from))};
  }
  constexpr int halvings = 52;
  double inside = begins ? 0.0 : 1.0, outside = 1.0 - inside;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (inside + outside);
    (is_inside(shape, from + middle * (to - from)) ? inside : outside) = middle;
  }
  return begins ? Stay{0.0, inside} : Stay{inside, 1.0};
}

bool RegionParts::matches(const Part &part, double share, const std::vector<Stay> &stays) const {
  const auto match = [&](const Part &inner) { return matches(inner, share, stays); };
  const bool inside = part.parts.empty() ? stays[part.shape].covers(share)
                      : part.is_union    ? std::any_of(part.parts.begin(), part.parts.end(), match)
                                         : std::all_of(part.parts.begin(), part.parts.end(), match);
  return inside == (part.region->interior != 0);
}

std::optional<spot::WallOnPath> RegionParts::first_wall(const Vector3 &from, const Vector3 &to) const {
  const double tolerance = tolerance_ / (to - from).norm();
  if (!std::isfinite(tolerance)) return std::nullopt;
  std::vector<Stay> stays;
  std::vector<double> changes = {0.0, 1.0};
  for (Region *shape : shapes_) {
    Stay inside = stay(*shape, from, to);
    if (inside.enters <= inside.leaves) {
      // Shapes that touch have no gap between them, and a plate without thickness is a wall.
      inside.enters -= tolerance;
      inside.leaves += tolerance;
      for (const double change : {inside.enters, inside.leaves})
        if (change > 0.0 && change < 1.0) changes.push_back(change);
    }
    stays.push_back(inside);
  }
  std::sort(changes.begin(), changes.end());
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const double next = k + 1 < changes.size() ? changes[k + 1] : 1.0;
    if (!matches(whole_, changes[k], stays) || !matches(whole_, 0.5 * (changes[k] + next), stays))
      return spot::WallOnPath{changes[k], normal(from, to, changes[k], stays)};
  }
  return std::nullopt;
}

/// Of the shapes whose surface is here, the face that the path meets first.
Vector3 RegionParts::normal(const Vector3 &from, const Vector3 &to, double share,
                            const std::vector<Stay> &stays) const {
  const double length = (to - from).norm(), near = 4.0 * tolerance_;
  const Vector3 along = (to - from) / length;
  const Vector3 at = from + std::max(0.0, share * length - near) * along;
  Vector3 normal = Vector3::Zero();
  double first = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    const double enters = std::abs(stays[k].enters - share), leaves = std::abs(stays[k].leaves - share);
    if (std::min(enters, leaves) * length > near) continue;
    const bool inside = is_inside(*shapes_[k], at);
    visit_faces(*shapes_[k], inside, at, 4.0 * near, [&](const Vector3 &from_wall) {
      // A path that touches may be seen from the wrong side of the surface.
      const double distance = from_wall.norm(), side = inside == (leaves < enters) ? 1.0 : -1.0;
      const double nearer = -side * from_wall.dot(along) / distance;
      if (!(nearer > 0.0) || distance / nearer >= first) return;
      first = distance / nearer;
      normal = side * from_wall / distance;
    });
  }
  return normal;
}

}  // namespace LAMMPS_NS
