// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "spot/geometry/surface.hpp"

namespace spot {

/// An edge: where two surfaces meet.
class Curve {
 public:
  virtual ~Curve() = default;

  /// Calls visit(point) for the points at which the distance from a place has a minimum along the curve, as far as they
  /// are within `reach`; for more than those, perhaps.
  virtual void visit_nearest(const Vector3& place, double reach,
                             const std::function<void(const Vector3&)>& visit) const = 0;

  /// Where it passes through a third surface; nothing if it lies in that, within `tolerance`.
  virtual std::vector<Vector3> meetings(const Surface& surface, double tolerance) const = 0;
};

class StraightCurve : public Curve {
 public:
  explicit StraightCurve(const Line& line) : line_(line) {}
  void visit_nearest(const Vector3& place, double reach,
                     const std::function<void(const Vector3&)>& visit) const override;
  std::vector<Vector3> meetings(const Surface& surface, double tolerance) const override;

 private:
  Line line_;
};

/// A curve that is known as a smooth function of a parameter between 0 and 1: minima and roots are bracketed by samples
/// and then closed in on.
class SampledCurve : public Curve {
 public:
  void visit_nearest(const Vector3& place, double reach,
                     const std::function<void(const Vector3&)>& visit) const override;
  std::vector<Vector3> meetings(const Surface& surface, double tolerance) const override;

 protected:
  /// Once the rest of the object stands.
  void take_samples(bool closed);

 private:
  virtual Vector3 at(double parameter) const = 0;

  std::vector<Vector3> samples_;
  std::vector<double> gaps_;  ///< the longer of the distances to the samples before and after
  bool closed_ = false;
};

class Circle : public SampledCurve {
 public:
  /// `axis` is a unit vector.
  Circle(const Vector3& centre, const Vector3& axis, double radius);
  /// Exact; one of them from the axis, where all are as near.
  void visit_nearest(const Vector3& place, double reach,
                     const std::function<void(const Vector3&)>& visit) const override;

 private:
  Vector3 at(double parameter) const override;

  Vector3 centre_, axis_, first_, second_;
  double radius_;
};

/// The generators of a ruled surface, as far as they meet another one, at one of the two roots of its equation.
class CurveOverGenerators : public SampledCurve {
 public:
  /// From one angle to another, as of Surface::generator: the whole turn or between two angles at which generators
  /// begin or end to meet the other surface. The surfaces must outlive this.
  CurveOverGenerators(const Surface& ruled, const Surface& other, bool plus, double first, double last, bool closed);

 private:
  Vector3 at(double parameter) const override;

  const Surface& ruled_;
  const Surface& other_;
  bool plus_;
  double first_, last_;
  bool closed_;
};

}  // namespace spot
