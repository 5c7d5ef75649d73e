// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "spot/geometry/outlet.hpp"
#include "spot/geometry/periodic.hpp"

namespace spot {

/// The outlets of a container, in the order in which rates of injection are given for them. All lie at one height: the
/// base is one plate, there are no walls below it, and grains are taken out below one height.
class Outlets {
 public:
  /// Just one.
  Outlets(const Outlet& outlet) : all_({outlet}) {}
  Outlets(const Orifice& orifice) : Outlets(Outlet(orifice)) {}

  /// Throws InvalidContainer, naming both, if two lie at different heights, or the rectangles around them, with sides
  /// along x and y, overlap; or if there is none.
  explicit Outlets(std::vector<Outlet> all);

  std::vector<Outlet>::const_iterator begin() const { return all_.begin(); }
  std::vector<Outlet>::const_iterator end() const { return all_.end(); }
  std::size_t size() const { return all_.size(); }
  const Outlet& operator[](std::size_t number) const { return all_[number]; }

  /// The same where space repeats: a slot as long as the period has no ends along that axis, and begins with the cell.
  Outlets repeated(const Periodic& periodic) const;

  /// Throws InvalidContainer, naming it, if one reaches out of the cell that repeats.
  void require_within(const Periodic& periodic) const;

  double height() const { return all_.front().centre.z(); }

  /// That whose hole is nearest to a place, or around it, whatever its height.
  const Outlet& nearest(const Vector3& place) const;

  /// The share of a straight path that lies before it passes the height of the outlets, if it does.
  std::optional<double> passed_at(const Vector3& from, const Vector3& to) const;

 private:
  std::vector<Outlet> all_;
};

}  // namespace spot
