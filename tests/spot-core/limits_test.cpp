// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes.hpp"
#include "spot/base/errors.hpp"

namespace {

using scenes::text_of;
using spot::CollapsedPacking;
using spot::Grain;
using spot::GrainChecks;
using spot::InvalidPacking;
using testing::HasSubstr;

/// A silo of 12 x 8 diameters with an orifice of radius 4.
GrainChecks checks() { return {spot::DrainageLimits{-1.0, 0.03, 0.2}, scenes::small_silo(6.0, 4.0), 1.0}; }

TEST(GrainChecksUnit, LimitsMustBePositive) {
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    EXPECT_THAT(text_of<spot::InvalidParameter>([&] {
                  spot::DrainageLimits{0.0, bad}.validate();
                }),
                HasSubstr("largest overlap at the start is "));
    EXPECT_THAT(text_of<spot::InvalidParameter>([&] {
                  spot::DrainageLimits{0.0, 0.03, bad}.validate();
                }),
                HasSubstr("largest overlap in flow is "));
  }
}

TEST(GrainChecksUnit, PlacesOfGrains) {
  const Grain inside{1, {0.0, 0.0, 3.0}}, falling{2, {1.0, 0.0, -0.5}}, low{3, {1.0, 0.0, -1.5}},
      out{4, {7.0, 0.0, 3.0}};
  for (const Grain& grain : {inside, falling}) EXPECT_NO_THROW(checks().require_valid_place(grain));
  EXPECT_NO_THROW(checks().require_inside(low)) << "it has left through the orifice";
  EXPECT_THAT(text_of<InvalidPacking>([&] { checks().require_valid_place(low); }),
              HasSubstr("grain 3 at (1, 0, -1.5)"));
  EXPECT_THAT(text_of<InvalidPacking>([&] { checks().require_inside(out); }), HasSubstr("grain 4 at (7, 0, 3)"));
}

TEST(GrainChecksUnit, OverlapsWithWalls) {
  EXPECT_EQ(checks().depth_in_walls({1, {0.0, 0.0, 3.0}}), 0.0);
  EXPECT_NEAR(checks().depth_in_walls({1, {5.6, 0.0, 3.0}}), 0.1, 1e-12);
  EXPECT_EQ(checks().depth_in_walls({1, {5.6, 0.0, 3.0}, true}), 0.0) << "held grains may be part of walls";
  EXPECT_NO_THROW(checks().require_off_walls({0.03, 5, 5}, "now"));
  EXPECT_THAT(text_of<InvalidPacking>([] {
                checks().require_off_walls({0.04, 5, 5}, "now");
              }),
              HasSubstr("grain 5 overlaps a wall by 0.04 diameters now; at most 0.03"));
}

TEST(GrainChecksUnit, OverlapsOfGrains) {
  EXPECT_THAT(text_of<InvalidPacking>([] {
                checks().require_shallow({0.04, 5, 6}, "now");
              }),
              HasSubstr("grains 5 and 6 overlap by 0.04 diameters now; at most 0.03"));
  EXPECT_NO_THROW(checks().require_no_collapse({0.2, 5, 6}));
  EXPECT_THAT(text_of<CollapsedPacking>([] {
                checks().require_no_collapse({0.21, 5, 6});
              }),
              HasSubstr("at most 0.2 is allowed"));
  const spot::DrainageLimits deep{0.0, 0.4, 0.2};
  EXPECT_EQ(deep.overlap_allowed(), 0.4) << "what the start may have, flow may, too";
}

TEST(GrainChecksUnit, GrainsLeaveThroughTheOrifice) {
  EXPECT_NO_THROW(checks().require_left_through_orifice({{1, {0.0, 0.0, -1.1}}, {2, {3.0, 0.0, -1.1}}}));
  EXPECT_THAT(text_of<CollapsedPacking>([] {
                checks().require_left_through_orifice({{1, {0, 0, -1.1}}, {2, {5.9, 3.9, -1.1}}});
              }),
              HasSubstr("grain 2 at (5.9, 3.9, -1.1) left through the base"));
}

}  // namespace
