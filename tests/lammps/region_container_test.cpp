// SPDX-License-Identifier: GPL-2.0-or-later
// Regions of LAMMPS as walls, in this process: spots that walk in them, against shapes that are computed here.
#include "lammps_headers.h"

#include "domain.h"
#include "input.h"
#include "lammps.h"
#include "region.h"
#include "region_container.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "spot/base/errors.hpp"

namespace {

using LAMMPS_NS::RegionContainer;
using spot::InvalidContainer;
using spot::message;
using spot::Orifice;
using spot::SpotBuffers;
using spot::Vector3;
using spot::WallContacts;
using testing::AllOf;
using testing::HasSubstr;

const double infinity = std::numeric_limits<double>::infinity();

template <typename Domain>
auto region_of(Domain& domain, const std::string& id, int) -> decltype(domain.get_region_by_id(id)) {
  return domain.get_region_by_id(id);
}
template <typename Domain>
auto region_of(Domain& domain, const std::string& id, long) -> decltype(domain.regions[domain.find_region(id)]) {
  return domain.regions[domain.find_region(id)];
}

/// Regions of one LAMMPS, deleted at the end.
class Regions {
 public:
  Regions() {
    if (!lammps_) {
      static const char* words[] = {"test", "-log", "none", "-screen", "none", "-nocite"};
      lammps_ = std::make_unique<LAMMPS_NS::LAMMPS>(6, const_cast<char**>(words), MPI_COMM_WORLD);
    }
  }
  ~Regions() {
    for (auto id = ids_.rbegin(); id != ids_.rend(); ++id) one("region " + *id + " delete");
  }

  void add(const std::string& id, const std::string& words) {
    one("region " + id + " " + words);
    ids_.push_back(id);
  }
  RegionContainer container(const std::string& id, const Orifice& orifice, const SpotBuffers& buffers) const {
    LAMMPS_NS::Domain& domain = *lammps_->domain;
    return {region_of(domain, id, 0), domain, orifice, buffers};
  }
  std::string error(const std::string& id, const Orifice& orifice) const {
    try {
      container(id, orifice, {0.25, 2.0});
    } catch (const InvalidContainer& error) {
      return error.what();
    }
    return "no error";
  }
  static void end() { lammps_.reset(); }

 private:
  static void one(const std::string& command) { lammps_->input->one(command.c_str()); }

  static std::unique_ptr<LAMMPS_NS::LAMMPS> lammps_;
  std::vector<std::string> ids_;
};
std::unique_ptr<LAMMPS_NS::LAMMPS> Regions::lammps_;

/// How far a place is inside a shape at least, negative outside: it changes no faster than the place.
using Margin = std::function<double(const Vector3&)>;

class Draws {
 public:
  explicit Draws(unsigned seed) : engine_(seed) {}
  double from(double low, double high) { return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0); }
  int below(int n) { return static_cast<int>(from(0.0, n)); }
  bool happens(double chance) { return from(0.0, 1.0) < chance; }
  Vector3 in_box(double half) { return {from(-half, half), from(-half, half), from(-half, half)}; }

 private:
  std::mt19937 engine_;
};

struct Shape {
  std::string words;
  Margin inside;
  int faces;  ///< that can be open
  bool odd_cone = false;
};

Shape block(Draws& draws) {
  const Vector3 a = draws.in_box(9.0);
  // Some are plates, down to none at all in thickness.
  const int thin = draws.happens(0.4) ? draws.below(3) : -1;
  Vector3 b = a;
  for (int k = 0; k < 3; ++k) b[k] += k == thin ? draws.below(3) * draws.from(0.0, 0.3) : draws.from(1.0, 15.0);
  return {message("block ", a.x(), ' ', b.x(), ' ', a.y(), ' ', b.y(), ' ', a.z(), ' ', b.z()),
          [=](const Vector3& p) { return std::min((p - a).minCoeff(), (b - p).minCoeff()); }, 6};
}

/// A cone, or a cylinder, along any axis.
Shape round(Draws& draws, bool cone) {
  const int axis = draws.below(3), one = axis == 0 ? 1 : 0, other = axis == 2 ? 1 : 2;
  const double c1 = draws.from(-8, 8), c2 = draws.from(-8, 8), lo = draws.from(-9, 5), hi = lo + draws.from(0.5, 12);
  const double wide = draws.from(0.4, 9.0);
  double r_lo = wide, r_hi = cone ? draws.from(0.3, 10.0) : wide;
  const bool pointed = cone && draws.happens(0.3);
  if (pointed) (draws.happens(0.5) ? r_lo : r_hi) = 0.0;
  const double slope = (r_hi - r_lo) / (hi - lo), cosine = 1.0 / std::sqrt(1.0 + slope * slope);
  const std::string radii = cone ? message(r_lo, ' ', r_hi) : message(wide);
  return {message(cone ? "cone " : "cylinder ", "xyz"[axis], ' ', c1, ' ', c2, ' ', radii, ' ', lo, ' ', hi),
          [=](const Vector3& p) {
            const double r = std::hypot(p[one] - c1, p[other] - c2), along = p[axis] - lo;
            return std::min({(r_lo + slope * along - r) * cosine, along, hi - p[axis]});
          },
          3, pointed || (cone && axis == 1)};
}

Shape sphere(Draws& draws) {
  const Vector3 c = draws.in_box(8.0);
  const double radius = draws.from(1.0, 10.0);
  return {message("sphere ", c.x(), ' ', c.y(), ' ', c.z(), ' ', radius),
          [=](const Vector3& p) { return radius - (p - c).norm(); }, 0};
}

Shape plane(Draws& draws) {
  const Vector3 at = draws.in_box(6.0), normal = draws.in_box(1.0);
  return {message("plane ", at.x(), ' ', at.y(), ' ', at.z(), ' ', normal.x(), ' ', normal.y(), ' ', normal.z()),
          [=](const Vector3& p) { return (p - at).dot(normal.normalized()); }, 0};
}

Shape prism(Draws& draws) {
  const Vector3 a = draws.in_box(8.0), size(draws.from(2, 12), draws.from(2, 12), draws.from(2, 12));
  const Vector3 tilt(draws.from(-4, 4), draws.from(-4, 4), draws.from(-4, 4));  // xy, xz, yz
  const Vector3 b = a + size;
  Eigen::Matrix3d edges;
  edges << size.x(), tilt[0], tilt[1], 0.0, size.y(), tilt[2], 0.0, 0.0, size.z();
  const Eigen::Matrix3d inverse = edges.inverse();
  return {message("prism ", a.x(), ' ', b.x(), ' ', a.y(), ' ', b.y(), ' ', a.z(), ' ', b.z(), ' ', tilt[0], ' ',
                  tilt[1], ' ', tilt[2]),
          [=](const Vector3& p) {
            const Vector3 t = inverse * (p - a);
            double least = infinity;
            for (int k = 0; k < 3; ++k) least = std::min(least, std::min(t[k], 1.0 - t[k]) / inverse.row(k).norm());
            return least;
          },
          6};
}

Shape any_shape(Draws& draws) {
  switch (draws.below(6)) {
    case 0:
      return plane(draws);
    case 1:
      return sphere(draws);
    case 2:
      return round(draws, false);
    case 3:
      return round(draws, true);
    case 4:
      return prism(draws);
    default:
      return block(draws);
  }
}

/// Where the test's regions open: far away, in a silo of its own below all else.
const Orifice far_mouth{{100.0, 100.0, -30.0}, 4.0};

/// Up to five random shapes in random unions and intersections of each other, within a block, and the silo with the
/// mouth.
struct RandomRegion {
  Regions regions;
  Margin inside;
  std::string open_part;  ///< its ID, if there is one
  bool odd_cone = false;  ///< is one of the shapes a cone with a point, or along y?
  std::string words;      ///< all commands

  RandomRegion(Draws& draws, bool open) {
    struct Made {
      std::string id;
      Margin inside;
    };
    std::vector<Made> made;
    const auto add = [&](const std::string& id, std::string command, const Margin& margin, double chance_of_outside) {
      const bool outside = draws.happens(chance_of_outside);
      if (outside) command += " side out";
      words += "region " + id + " " + command + "\n";
      regions.add(id, command);
      made.push_back({id, outside ? Margin([margin](const Vector3& p) { return -margin(p); }) : margin});
    };
    const int shapes = 1 + draws.below(5), open_shape = open ? draws.below(shapes) : -1;
    for (int k = 0; k < shapes; ++k) {
      Shape shape = any_shape(draws);
      const std::string id = message("shape", k);
      if (k == open_shape) {
        while (shape.faces == 0) shape = any_shape(draws);
        shape.words += message(" open ", 1 + draws.below(shape.faces));
        open_part = id;
      }
      odd_cone = odd_cone || shape.odd_cone;
      add(id, shape.words, shape.inside, 0.35);
    }
    for (int k = 0; made.size() > 1; ++k) {
      const std::size_t n = 2 + static_cast<std::size_t>(draws.below(static_cast<int>(made.size()) - 1));
      const bool all = draws.happens(0.5);
      std::string command = message(all ? "intersect " : "union ", n);
      std::vector<Margin> parts;
      for (std::size_t i = 0; i < n; ++i) {
        const auto which = made.begin() + draws.below(static_cast<int>(made.size()));
        command += " " + which->id;
        parts.push_back(which->inside);
        made.erase(which);
      }
      const Margin margin = [parts, all](const Vector3& p) {
        double value = all ? infinity : -infinity;
        for (const Margin& part : parts) value = all ? std::min(value, part(p)) : std::max(value, part(p));
        return value;
      };
      add(message("group", k), command, margin, 0.1);
    }
    inside = [within = made[0].inside](const Vector3& p) {
      return std::min(12.0 - p.cwiseAbs().maxCoeff(), within(p));
    };
    regions.add("bound", "block -12 12 -12 12 -12 12");
    regions.add("within", "intersect 2 bound " + made[0].id);
    regions.add("far_silo", "block 90 110 90 110 -30 -20");
    regions.add("far_pipe", "cylinder z 100 100 4 -38 -29.996");
    regions.add("whole", "union 3 within far_silo far_pipe");
  }
};

/// The least margin on a straight path, as far as that can be seen in steps of 1e-4.
double least_margin(const Margin& inside, const Vector3& from, const Vector3& to) {
  const double length = (to - from).norm();
  double least = inside(to);
  for (double gone = 0.0; gone < length;) {
    const double here = inside(from + (gone / length) * (to - from));
    least = std::min(least, here);
    if (least < -1e-3) break;
    gone += std::max(1e-4, here);
  }
  return least;
}

constexpr double rounding = 2e-6;  // of walls, in grain diameters

TEST(RegionContainerBruteForce, SpotsNeverLeaveRandomRegions) {
  Draws draws(20261);
  int refused = 0, odd_cones = 0, steps = 0, still = 0, reflected = 0, empty = 0;
  for (int region = 0; region < 2000; ++region) {
    const bool open = region % 4 == 3;
    const RandomRegion random(draws, open);
    SCOPED_TRACE(random.words);
    if (open) {
      const std::string error = random.regions.error("whole", far_mouth);
      ASSERT_THAT(error, AllOf(HasSubstr("'" + random.open_part + "'"), HasSubstr("open face")));
      ++refused;
      continue;
    }
    const double buffer = draws.happens(0.3) ? 0.0 : draws.from(0.1, 1.0);
    const std::string error = random.regions.error("whole", far_mouth);
    if (error != "no error") {
      ASSERT_TRUE(random.odd_cone && error.find("is a cone") != std::string::npos) << error;
      ++odd_cones;
      continue;
    }
    const RegionContainer container = random.regions.container("whole", far_mouth, {buffer, 2.0});
    Vector3 spot = draws.in_box(12.0);
    for (int trial = 0; trial < 5000 && random.inside(spot) < 1e-3; ++trial) spot = draws.in_box(12.0);
    if (random.inside(spot) < 1e-3) {
      ++empty;
      continue;
    }
    const double width = draws.from(0.3, 2.6), height = draws.from(0.05, 1.2);
    const Vector3 born = spot;
    for (int step = 0; step < 100; ++step) {
      Vector3 target = spot + Vector3(0.0, 0.0, height);
      target[draws.below(2)] += draws.happens(0.5) ? width : -width;
      const Vector3 next = container.keep_spot_inside(spot, target);
      ASSERT_GE(least_margin(random.inside, spot, next), -rounding)
          << "from " << spot.transpose() << " to " << next.transpose() << ", wanted " << target.transpose();
      ++steps;
      still += next == spot;
      reflected += next != spot && (next - target).norm() > 1e-12;
      // Spots that have reached the top start again.
      spot = next == spot ? born : next;
    }
  }
  EXPECT_EQ(refused, 500);
  EXPECT_LT(odd_cones, 400);
  EXPECT_LT(empty, 300);
  EXPECT_GT(steps, 90000);
  EXPECT_LT(still, steps / 4);
  EXPECT_GT(reflected, steps / 20);
}

/// Against marching through the shapes: what it misses, and what is not there.
TEST(RegionContainerBruteForce, FirstWallIsWhereTheRegionEnds) {
  Draws draws(20262);
  int walls = 0, free = 0;
  for (int region = 0; region < 500; ++region) {
    const RandomRegion random(draws, false);
    SCOPED_TRACE(random.words);
    if (random.regions.error("whole", far_mouth) != "no error") continue;
    const RegionContainer container = random.regions.container("whole", far_mouth, {0.25, 2.0});
    for (int path = 0; path < 40; ++path) {
      const Vector3 from = draws.in_box(12.0), to = draws.in_box(12.0);
      if (random.inside(from) < 1e-3) continue;
      const auto wall = container.first_wall(from, to);
      if (!wall) {
        ASSERT_GE(least_margin(random.inside, from, to), -rounding) << from.transpose() << " to " << to.transpose();
        ++free;
        continue;
      }
      ++walls;
      const Vector3 at = from + wall->share * (to - from);
      ASSERT_GE(least_margin(random.inside, from, at), -rounding) << from.transpose() << " to " << to.transpose();
      ASSERT_LT(std::abs(random.inside(at)), 1e-5) << from.transpose() << " to " << to.transpose();
      EXPECT_NEAR(wall->normal.norm(), 1.0, 1e-9);
      EXPECT_LT(wall->normal.dot(to - from), 0.0);
    }
  }
  EXPECT_GT(walls, 1000);
  EXPECT_GT(free, 200);
}

/// Plates thinner than a step, down to no thickness; and where spots start on the axis of a shape, to whose wall LAMMPS
/// knows no way.
TEST(RegionContainerAnalytic, BafflesHoldSpotsOnTheirSide) {
  for (const double thickness : {0.0, 1e-3, 0.5}) {
    Regions regions;
    regions.add("silo", "block -10 10 -4 4 0 33");
    regions.add("pipe", "cylinder z -5 0 4 -8 0.004");
    regions.add("plate", message("block 0 ", thickness, " -4 4 0 30 side out"));
    regions.add("silo_pipe", "union 2 silo pipe");
    regions.add("whole", "intersect 2 silo_pipe plate");
    const RegionContainer container = regions.container("whole", {{-5.0, 0.0, 0.0}, 4.0}, {0.25, 2.0});
    Draws draws(7);
    double rightmost = -infinity;
    for (int spot = 0; spot < 200; ++spot) {
      Vector3 at(-5.0, 0.0, -3.5);
      for (int step = 0; step < 120 && at.z() < 27.0; ++step) {
        Vector3 target = at + Vector3(0.0, 0.0, 0.3);
        target[draws.below(2)] += draws.happens(0.5) ? 2.6 : -2.6;
        at = container.keep_spot_inside(at, target);
        rightmost = std::max(rightmost, at.x());
        ASSERT_LE(at.x(), -0.25 + 1e-9) << "plate " << thickness;
      }
      EXPECT_GE(at.z(), 27.0) << "it climbs";
    }
    EXPECT_GT(rightmost, -0.3) << "and comes close to the plate";
  }
  Regions regions;
  regions.add("narrow", "cylinder z 0 0 1 0 33 open 1");
  const RegionContainer container = regions.container("narrow", {{0.0, 0.0, 0.0}, 1.0}, {0.25, 0.5});
  EXPECT_LE(container.keep_spot_inside({0.0, 0.0, 5.0}, {2.6, 0.0, 6.0}).head<2>().norm(), 0.75 + 1e-9);
}

/// A region of one shape may have an open face at the orifice.
TEST(RegionContainerAnalytic, SpotsStayInsideShapesWithAnOpenBottom) {
  struct Case {
    const char* words;
    Margin inside;
  };
  const std::vector<Case> cases = {
      {"cone z 0 0 4 10 0 12 open 1",
       [](const Vector3& p) { return std::min(4.0 + 0.5 * p.z() - p.head<2>().norm(), 12.0 - p.z()); }},
      {"cone z 0 0 4 10 0 12 open 1 open 2",
       [](const Vector3& p) { return std::min(4.0 + 0.5 * p.z() - p.head<2>().norm(), 12.0 - p.z()); }},
      {"cylinder z 0 0 4.5 0 20 open 1",
       [](const Vector3& p) { return std::min(4.5 - p.head<2>().norm(), 20.0 - p.z()); }},
      {"block -4 4 -4.4 4.4 0 20 open 5", [](const Vector3& p) {
         return std::min({4.0 - std::abs(p.x()), 4.4 - std::abs(p.y()), 20.0 - p.z()});
       }}};
  for (const Case& c : cases) {
    Regions regions;
    regions.add("silo", c.words);
    const RegionContainer container = regions.container("silo", {{0.0, 0.0, 0.0}, 4.0}, {0.25, 2.0});
    Draws draws(8);
    double highest = 0.0;
    for (int spot = 0; spot < 200; ++spot) {
      Vector3 at(0.0, 0.0, -3.5);
      for (int step = 0; step < 100; ++step) {
        Vector3 target = at + Vector3(0.0, 0.0, 0.5);
        target[draws.below(2)] += draws.happens(0.5) ? 1.7 : -1.7;
        at = container.keep_spot_inside(at, target);
        const double inside = at.z() > 0.0 ? c.inside(at) : 2.0 - at.head<2>().norm();
        ASSERT_GE(inside, -rounding) << c.words << ": " << at.transpose();
        highest = std::max(highest, at.z());
      }
    }
    EXPECT_GT(highest, 11.0) << c.words;
  }
}

TEST(RegionContainerUnit, PartsWithOpenFacesAreNamed) {
  const Orifice orifice{{1.0, 2.0, 0.0}, 4.0};
  Regions regions;
  regions.add("funnel", "cone z 1 2 4 10 0 12 open 1");
  regions.add("bin", "cylinder z 1 2 10 12 31");
  regions.add("both", "union 2 funnel bin");
  regions.add("bound", "block -9 9 -9 9 -9 20");
  regions.add("cut", "intersect 2 bound both");
  regions.add("outer", "cylinder z 1 2 4 0 31 open 1 side out");
  regions.add("open_union", "union 2 bin bound open 1");
  const auto named = [&](const char* part) {
    return AllOf(HasSubstr(message("'", part, "'")), HasSubstr("open"), HasSubstr("cylinder z 1 2 4 -8 0.004"));
  };
  EXPECT_THAT(regions.error("both", orifice), named("funnel"));
  EXPECT_THAT(regions.error("cut", orifice), named("funnel")) << "nested";
  EXPECT_THAT(regions.error("outer", orifice), named("outer"));
  EXPECT_THAT(regions.error("open_union", orifice), named("open_union"));
  EXPECT_EQ(regions.error("funnel", orifice), "no error");
}

/// LAMMPS does not see the surface of a cone with a point from outside, nor the ends of one along y.
TEST(RegionContainerUnit, ConesThatLammpsGetsWrongAreNamed) {
  Regions regions;
  regions.add("closed", "block -20 20 -20 20 0 30");
  regions.add("pipe", "cylinder z 0 0 4 -8 0.004");
  regions.add("silo", "union 2 closed pipe");
  regions.add("tip", "cone z 0 0 5 0 10 20 side out");
  regions.add("tip_below", "cone z 0 0 0 5 10 20");
  regions.add("outside", "union 2 tip_below tip_below side out");
  regions.add("blunt", "cone z 0 0 5 1e-3 10 20 side out");
  for (const char* tip : {"tip", "outside", "blunt"})
    regions.add(message("with_", tip), message("intersect 2 silo ", tip));
  const Orifice orifice{{0.0, 0.0, 0.0}, 4.0};
  EXPECT_THAT(regions.error("with_tip", orifice), AllOf(HasSubstr("'tip'"), HasSubstr("a cone with a point")));
  EXPECT_THAT(regions.error("with_outside", orifice),
              AllOf(HasSubstr("'tip_below'"), HasSubstr("a cone with a point")));
  EXPECT_EQ(regions.error("with_blunt", orifice), "no error");
  regions.add("trough", "cone y 0 5 5 4 -9 9");
  regions.add("with_trough", "union 2 silo trough");
  EXPECT_THAT(regions.error("with_trough", orifice), AllOf(HasSubstr("'trough'"), HasSubstr("a cone along y")));
  regions.add("ridge", "cone y 0 5 5 4 -9 9 side out");
  regions.add("hollow", "union 2 ridge ridge side out");
  regions.add("with_hollow", "union 2 silo hollow");
  regions.add("with_ridge", "intersect 2 silo ridge");
  EXPECT_THAT(regions.error("with_hollow", orifice), AllOf(HasSubstr("'ridge'"), HasSubstr("a cone along y")));
  EXPECT_EQ(regions.error("with_ridge", {{0.0, 0.0, 0.0}, 4.0}).find("a cone along y"), std::string::npos);
}

/// Of a silo with a flat floor at z = 0, a hole of radius 4 in it, and things in the way.
TEST(RegionContainerUnit, TheOrificeHasToLieInAnOpening) {
  Regions regions;
  regions.add("closed", "block -20 20 -20 20 0 30");
  regions.add("pipe", "cylinder z 0 0 4 -8 0.004");
  regions.add("silo", "union 2 closed pipe");
  regions.add("lid", "block -5 5 -5 5 0.1 0.2 side out");
  regions.add("covered", "intersect 2 silo lid");
  regions.add("thin", "block -5 5 -5 5 0 0 side out");
  regions.add("shut", "intersect 2 silo thin");
  regions.add("strip", "block -5 5 0 1 0.1 0.2 side out");
  regions.add("half", "intersect 2 silo strip");
  regions.add("no_floor", "block -20 20 -20 20 -10 30");
  regions.add("open_floor", "block -20 20 -20 20 0 30 open 5");
  regions.add("open_square", "block -4 4 -4 4 0 30 open 5");
  regions.add("narrowing", "cone z 0 0 4 2 0 20 open 1");
  const auto at = [](double x, double radius) { return Orifice{{x, 0.0, 0.0}, radius}; };
  const auto says = [&](const char* region, const Orifice& orifice, const char* what) {
    EXPECT_THAT(regions.error(region, orifice),
                AllOf(HasSubstr(message("'", region, "'")), HasSubstr(what),
                      HasSubstr(message("orifice of radius ", orifice.radius, " at (", orifice.centre.x()))))
        << region;
  };
  says("closed", at(0.0, 4.0), "a wall of");
  says("shut", at(0.0, 4.0), "a wall of");
  says("covered", at(0.0, 4.0), "a wall of");
  says("half", at(0.0, 4.0), "beyond the mouth");
  says("silo", at(9.0, 4.0), "a wall of");
  says("silo", at(2.0, 4.0), "beyond the mouth");
  says("silo", at(0.0, 4.1), "beyond the mouth");
  says("silo", at(30.0, 4.0), "outside");
  says("silo", at(4.0, 4.0), "beyond the mouth");
  says("silo", at(0.0, 2.6), "wider");
  says("no_floor", at(0.0, 4.0), "wider");
  says("open_floor", at(0.0, 4.0), "wider");
  EXPECT_EQ(regions.error("silo", at(0.0, 4.0)), "no error");
  EXPECT_EQ(regions.error("silo", at(0.0, 3.5)), "no error") << "somewhat wider";
  EXPECT_EQ(regions.error("open_square", at(0.0, 4.0)), "no error");
  EXPECT_EQ(regions.error("narrowing", at(0.0, 4.0)), "no error");
}

TEST(RegionContainerUnit, AWallAtDistanceZeroCounts) {
  Regions regions;
  regions.add("box", "block -4.4 4.4 -4 4 0 20 open 5");
  regions.add("ramp", "plane 5.5 0 1 -1 0 1");
  regions.add("ball", "sphere 0 0 12 2 side out");
  regions.add("closed", "block -6 6 -4 4 0 20");
  regions.add("pipe", "cylinder z 0 0 3.9 -8 0.004");
  regions.add("silo", "union 2 closed pipe");
  regions.add("odd", "intersect 3 silo ramp ball");
  const RegionContainer box = regions.container("box", {{0.0, 0.0, 0.0}, 4.0}, {0.25, 2.0});
  const RegionContainer odd = regions.container("odd", {{0.0, 0.0, 0.0}, 3.9}, {0.25, 2.0});
  const auto expect = [](const RegionContainer& container, const Vector3& at, std::vector<Vector3> normals) {
    WallContacts contacts;
    container.contacts(at, 0.5, contacts);
    ASSERT_EQ(contacts.end() - contacts.begin(), static_cast<std::ptrdiff_t>(normals.size())) << at.transpose();
    for (const Vector3& normal : normals)
      EXPECT_TRUE(std::any_of(contacts.begin(), contacts.end(),
                              [&](const spot::WallContact& contact) {
                                return (contact.normal - normal).norm() < 1e-5 && contact.distance < 1e-5;
                              }))
          << at.transpose() << ": " << normal.transpose();
  };
  expect(box, {4.4, 0.0, 5.0}, {{-1.0, 0.0, 0.0}});
  expect(box, {0.0, -4.0, 5.0}, {{0.0, 1.0, 0.0}});
  expect(box, {-4.4, 4.0, 5.0}, {{1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}});
  expect(odd, {5.25, 0.0, 0.75}, {Vector3(-1.0, 0.0, 1.0).normalized()});
  expect(odd, {-6.0, -4.0, 0.0}, {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}});
  expect(odd, {2.0, 0.0, 12.0}, {{1.0, 0.0, 0.0}});
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  MPI_Init(&argc, &argv);
  const int failed = RUN_ALL_TESTS();
  Regions::end();
  MPI_Finalize();
  return failed;
}
