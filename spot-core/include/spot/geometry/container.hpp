// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "spot/base/vector.hpp"
#include "spot/geometry/periodic.hpp"

namespace spot {

/// The nearest point of a wall, seen from a grain: how far it is from the grain's centre, and the unit
/// normal that points from it to the centre.
struct WallContact {
  double distance;
  Vector3 normal;
};

/// A flat wall across an axis.
struct AxisPlane {
  int axis;
  double at;          ///< where it crosses the axis
  bool grains_below;  ///< else above
};

/// The walls close to one grain. A grain in a corner touches three planes; eight leaves room for odd shapes.
class WallContacts {
 public:
  static constexpr int capacity = 8;

  void clear() { size_ = 0; }
  /// Throws InvalidContainer when more than `capacity` walls are close to one grain.
  void add(const WallContact& contact);
  const WallContact* begin() const { return contacts_.data(); }
  const WallContact* end() const { return contacts_.data() + size_; }

 private:
  std::array<WallContact, capacity> contacts_;
  int size_ = 0;
};

/// The round, horizontal hole through which grains leave and spots enter.
struct Orifice {
  Vector3 centre;
  double radius;

  /// `position` with its distance from the axis reflected to stay within `limit`, its height kept.
  Vector3 keep_within(double limit, const Vector3& position) const;

  /// The share of a straight path that lies before it passes the height of the orifice, if it does.
  std::optional<double> passed_at(const Vector3& from, const Vector3& to) const;
};

/// Where a straight path meets a wall.
struct WallOnPath {
  double share;    ///< of the path that lies before the wall, 0 to 1
  Vector3 normal;  ///< a unit vector from the wall to the side that the path comes from; zero where the wall has none
};

/// What holds the grains: walls near a point, the orifice, and where spots may go. z points up.
class Container {
 public:
  virtual ~Container() = default;

  /// Is this grain centre on the inner side of every wall?
  virtual bool contains(const Vector3& centre) const = 0;

  /// Fills `contacts` with all walls within `reach` of a grain centre.
  virtual void contacts(const Vector3& centre, double reach, WallContacts& contacts) const = 0;

  /// The flat walls across axes, for which there is a short cut.
  virtual const std::vector<AxisPlane>& axis_planes() const;

  /// As contacts(), without those of axis_planes().
  virtual void other_contacts(const Vector3& centre, double reach, WallContacts& contacts) const {
    this->contacts(centre, reach, contacts);
  }

  /// May several threads ask for contacts at the same time?
  virtual bool concurrent() const { return true; }

  virtual const Orifice& orifice() const = 0;

  /// Along which axes space repeats. All questions may be asked of places in any of its cells.
  virtual const Periodic& periodic() const;

  /// May a grain that is here now, below the orifice, have come out of it? Else it went through a wall.
  virtual bool may_have_left_to(const Vector3&) const { return true; }

  /// The first wall on the straight path between two places. Below the height of the orifice there are none.
  virtual std::optional<WallOnPath> first_wall(const Vector3& from, const Vector3& to) const = 0;

  /// Where a spot at `start` that wants to step to `target` ends. The step is straight, and no wall lies across it:
  /// it is reflected at walls, to end at least the spot's buffer away from each; where it is too narrow for that, only
  /// its upward part is taken, and no step at all where that would meet a wall.
  Vector3 keep_spot_inside(const Vector3& start, const Vector3& target) const;

  /// A message for every spot, thrown as InvalidContainer, if spots of this radius cannot enter.
  void require_entrance(double spot_radius) const;

 private:
  /// `target`, reflected until the spot fits there and no wall lies across the step from `start`; or nothing.
  virtual std::optional<Vector3> reflect_spot(const Vector3& start, const Vector3& target) const = 0;
};

/// One shape of wall. New shapes are new classes; the rest of spot-core does not change.
class Wall {
 public:
  virtual ~Wall() = default;

  /// The nearest point; a negative distance says that `centre` is behind the wall.
  virtual WallContact nearest(const Vector3& centre) const = 0;

  /// `target`, reflected to the inner side of the surface `buffer` in front of the wall.
  /// Reflection keeps spots that walk along a plane wall uniformly distributed in front of it.
  virtual Vector3 reflect_spot(double buffer, const Vector3& target) const;

  /// Where the straight path from the inner side passes this wall. A path that begins behind it meets it at once,
  /// unless it ends on the inner side.
  virtual std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const = 0;

  /// As of Container.
  virtual bool may_have_left_to(const Vector3&) const { return true; }

  /// The plane across an axis that this wall is, or nothing.
  virtual std::optional<AxisPlane> axis_plane() const { return std::nullopt; }
};

/// The plane through `point` with grains on the side that `normal` points to.
class PlaneWall : public Wall {
 public:
  /// Throws InvalidContainer if the normal is zero or not finite.
  PlaneWall(const Vector3& point, const Vector3& normal);
  WallContact nearest(const Vector3& centre) const override;
  std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const override;
  std::optional<AxisPlane> axis_plane() const override;

 private:
  Vector3 normal_;
  double offset_;
};

/// The inside of an upright cylinder around the vertical axis through (x, y).
class CylinderWall : public Wall {
 public:
  /// Throws InvalidContainer unless the radius is positive.
  CylinderWall(double x, double y, double radius);
  WallContact nearest(const Vector3& centre) const override;
  std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const override;

 private:
  double x_, y_, radius_;
};

/// A thin horizontal plate with a round hole. Grains over the hole see its rim, a circular edge.
class BasePlate : public Wall {
 public:
  explicit BasePlate(const Orifice& orifice);
  /// Grains below the plate see its lower side.
  WallContact nearest(const Vector3& centre) const override;
  /// Reflects towards the axis at constant height, so that a spot on its way up through the hole is not held back.
  Vector3 reflect_spot(double buffer, const Vector3& target) const override;
  /// From either side.
  std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const override;
  /// Below the hole grains spread no farther than they have come down.
  bool may_have_left_to(const Vector3& centre) const override;

 private:
  Orifice orifice_;
};

/// A container made of walls, each with the buffer that spots keep from it.
class WalledContainer : public Container {
 public:
  /// An empty space with an orifice; throws InvalidContainer unless its radius is positive.
  explicit WalledContainer(const Orifice& orifice);

  void add(std::unique_ptr<Wall> wall, double spot_buffer);

  /// Space repeats like this from now on. Walls are those of the cell: where one meets an end of it, it has to go on in
  /// the next cell as it does in space. Throws InvalidContainer if the orifice reaches out of the cell, or a flat wall
  /// stands across an axis along which it repeats.
  void repeat(const Periodic& periodic);
  const Periodic& periodic() const override { return periodic_; }

  bool contains(const Vector3& centre) const override;
  void contacts(const Vector3& centre, double reach, WallContacts& contacts) const override;
  const std::vector<AxisPlane>& axis_planes() const override { return axis_planes_; }
  void other_contacts(const Vector3& centre, double reach, WallContacts& contacts) const override;
  const Orifice& orifice() const override { return orifice_; }
  bool may_have_left_to(const Vector3& centre) const override;
  std::optional<WallOnPath> first_wall(const Vector3& from, const Vector3& to) const override;

 private:
  std::optional<Vector3> reflect_spot(const Vector3& start, const Vector3& target) const override;

  struct Bounded {
    std::unique_ptr<Wall> wall;
    double spot_buffer;
  };
  void require_no_period_across(const AxisPlane& plane) const;
  std::optional<Vector3> reflect_in_cell(const Vector3& start, const Vector3& target) const;
  std::optional<WallOnPath> first_wall_in_cell(const Vector3& from, const Vector3& to) const;

  Orifice orifice_;
  Periodic periodic_;
  std::vector<Bounded> walls_;
  std::vector<AxisPlane> axis_planes_;  // some of them once more
};

/// How far spot centres stay from the walls.
struct SpotBuffers {
  double side;  ///< d_w, from the side walls (2006: one diameter)
  double base;  ///< the same, from the base plate and the rim of its orifice
};

/// A silo with four vertical plane walls and a flat base at the height of the orifice's centre.
/// Throws InvalidContainer if the walls are in the wrong order or the orifice reaches beyond them.
std::unique_ptr<WalledContainer> box_silo(double x_low, double x_high, double y_low, double y_high,
                                          const Orifice& orifice, const SpotBuffers& buffers);

/// A silo with an upright cylindrical wall and a flat base at the height of the orifice's centre.
/// Throws InvalidContainer if the orifice reaches beyond the wall.
std::unique_ptr<WalledContainer> cylinder_silo(double x, double y, double radius, const Orifice& orifice,
                                               const SpotBuffers& buffers);

}  // namespace spot
