// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "scenes.hpp"

namespace {

using spot::InvalidParameter;
using spot::RelaxationParameters;
using spot::RelaxationStrength;
using spot::SpotParameters;
using testing::AllOf;
using testing::HasSubstr;

const double infinity = std::numeric_limits<double>::infinity();

struct Number {
  std::string word;
  double SpotParameters::*member;
};

class SpotParametersUnit : public testing::TestWithParam<Number> {};

TEST_P(SpotParametersUnit, OutOfRangeNamesTheWordAndTheBound) {
  for (const double bad : {0.0, -1.5, infinity, -infinity, std::nan("")}) {
    SpotParameters spots = scenes::paper_spots();
    spots.*GetParam().member = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { spots.validate(); }),
                AllOf(HasSubstr(GetParam().word + " is "), HasSubstr("must be positive and finite")));
  }
}

INSTANTIATE_TEST_SUITE_P(EachNumber, SpotParametersUnit,
                         testing::Values(Number{"spot radius", &SpotParameters::radius},
                                         Number{"spot influence", &SpotParameters::influence},
                                         Number{"spot step width", &SpotParameters::step_width},
                                         Number{"spot step height", &SpotParameters::step_height},
                                         Number{"spot speed", &SpotParameters::speed}),
                         [](const auto& number) {
                           std::string name = number.param.word;
                           name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
                           return name;
                         });

TEST(ParametersUnit, ARateOfInjectionThatIsNoneIsNamed) {
  for (const double bad : {0.0, -1.5, infinity, -infinity, std::nan("")}) {
    SpotParameters spots = scenes::paper_spots();
    spots.injection_rate = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { spots.validate(); }),
                AllOf(HasSubstr("spot injection rate is "), HasSubstr("must be positive and finite")));
  }
}

TEST(ParametersUnit, ThoseOf2006AreValid) {
  EXPECT_NO_THROW(scenes::paper_spots().validate());
  EXPECT_NO_THROW(RelaxationParameters().validate());
}

TEST(ParametersUnit, DefaultsMustBeFilledIn) { EXPECT_THROW(SpotParameters().validate(), InvalidParameter); }

TEST(ParametersUnit, InfluenceMustBeBelowOne) {
  SpotParameters spots = scenes::paper_spots();
  spots.influence = 1.0;
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { spots.validate(); }),
              AllOf(HasSubstr("spot influence is 1 "), HasSubstr("below 1")));
  spots.influence = 0.999;
  EXPECT_NO_THROW(spots.validate());
}

TEST(ParametersUnit, PersistenceMustBeBelowOne) {
  SpotParameters spots = scenes::paper_spots();
  for (const double wrong : {-0.1, 1.0, 1.0 / 0.0, std::nan("")}) {
    spots.persistence = wrong;
    spots.step_width = spot::step_width_for(1.0, 0.1, wrong);
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { spots.validate(); }),
                AllOf(HasSubstr("persistence"), HasSubstr("from 0 to below 1")));
  }
}

TEST(ParametersUnit, DilationIsAShare) {
  SpotParameters spots = scenes::paper_spots();
  for (const double wrong : {-0.1, 1.0, 1.0 / 0.0, std::nan("")}) {
    spots.dilation = wrong;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { spots.validate(); }),
                AllOf(HasSubstr("dilation"), HasSubstr("from 0 (off) to below 1")));
  }
  spots.dilation = 0.95;
  EXPECT_NO_THROW(spots.validate());
  spots.together = true;
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { spots.validate(); }), HasSubstr("step together"));
}

/// As the fitted ones.
SpotParameters critical_spots() {
  SpotParameters spots = scenes::paper_spots();
  spots.fixed_volume = 77.0;
  spots.critical_fraction = 0.58;
  spots.exchange_length = 2.0;
  return spots;
}

std::string refusal_of(const SpotParameters& spots) {
  return scenes::text_of<InvalidParameter>([&] { spots.validate(); });
}

TEST(ParametersUnit, WithoutACriticalStateSpotsAreThoseOf2006) {
  const SpotParameters spots;
  EXPECT_EQ(spots.critical_fraction, 0.0);
  EXPECT_EQ(spots.dilatancy, 0.0);
  EXPECT_EQ(spots.full_strain, 0.0);
}

TEST(ParametersUnit, CriticalPackingFractionsAreThoseOfGrainsInContact) {
  SpotParameters spots = critical_spots();
  for (const double good : {0.5, 0.58, 0.7}) {
    spots.critical_fraction = good;
    EXPECT_NO_THROW(spots.validate());
  }
  for (const double bad : {-0.58, 1e-300, 0.499, 0.701, 1.0, infinity, -infinity, std::nan("")}) {
    spots.critical_fraction = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("critical packing fraction is "), HasSubstr("from 0.5 to 0.7")));
  }
}

TEST(ParametersUnit, ACriticalStateNeedsAnExchangeLengthOfATenthOfAStep) {
  SpotParameters spots = critical_spots();
  for (const double bad : {0.0, -1.0, infinity, -infinity, std::nan("")}) {
    spots.exchange_length = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("exchange length is "), HasSubstr("must be positive and finite")));
  }
  spots.step_height = 0.8;
  spots.exchange_length = 0.079;
  EXPECT_THAT(refusal_of(spots),
              AllOf(HasSubstr("exchange length is 0.079 "), HasSubstr("at least 0.1 of"), HasSubstr("height, 0.8")));
  for (const double good : {0.081, 2.0, 1e300}) {
    spots.exchange_length = good;
    EXPECT_NO_THROW(spots.validate());
  }
  spots.critical_fraction = 0.0;
  spots.exchange_length = 0.0;
  EXPECT_NO_THROW(spots.validate()) << "it is off";
}

TEST(ParametersUnit, ACriticalStateNeedsAFixedVolume) {
  SpotParameters spots = critical_spots();
  spots.fixed_volume = 0.0;
  EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("critical packing fraction is 0.58 "), HasSubstr("no fixed volume")));
}

TEST(ParametersUnit, DilatancyIsNotNegativeAndLowersACriticalPackingFraction) {
  SpotParameters spots = critical_spots();
  for (const double good : {0.0, 0.1, 0.333 * spots.radius}) {
    spots.dilatancy = good;
    EXPECT_NO_THROW(spots.validate());
  }
  for (const double bad : {-0.1, infinity, -infinity, std::nan("")}) {
    spots.dilatancy = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("dilatancy is "), HasSubstr("zero (off) or positive")));
  }
  for (const double bad : {0.334 * spots.radius, 1e300}) {
    spots.dilatancy = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("dilatancy is "), HasSubstr("at most a third of the spot radius")));
  }
  spots = scenes::paper_spots();
  spots.dilatancy = 0.1;
  EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("dilatancy is 0.1 "), HasSubstr("needs a critical packing fraction")));
}

TEST(ParametersUnit, TheStrainOfFullExchangeIsBoundedAndNeedsACriticalPackingFraction) {
  SpotParameters spots = critical_spots();
  for (const double good : {0.0, 1e-300, 0.2, 2.999 / spots.radius}) {
    spots.full_strain = good;
    EXPECT_NO_THROW(spots.validate());
  }
  for (const double bad : {-0.2, infinity, -infinity, std::nan("")}) {
    spots.full_strain = bad;
    EXPECT_THAT(refusal_of(spots),
                AllOf(HasSubstr("strain of full exchange is "), HasSubstr("zero (full everywhere)")));
  }
  for (const double bad : {3.001 / spots.radius, 1e300}) {
    spots.full_strain = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("strain of full exchange is "), HasSubstr("three over the spot")));
  }
  spots = scenes::paper_spots();
  spots.full_strain = 0.2;
  EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("strain of full exchange is 0.2 "), HasSubstr("needs a critical")));
}

TEST(ParametersUnit, SpreadAndShearByWallsAreBounded) {
  SpotParameters spots = critical_spots();
  EXPECT_EQ(spots.spread, 0.0);
  for (const double good : {0.0, 0.6, 2.0}) {
    spots.spread = good;
    spots.wall_shear = 2.0 * good;
    EXPECT_NO_THROW(spots.validate());
  }
  for (const double bad : {-0.1, 2.1, infinity, -infinity, std::nan("")}) {
    spots.spread = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("spread is "), HasSubstr("from 0 (off) to 2")));
  }
  spots.spread = 0.6;
  for (const double bad : {-0.1, 4.1, infinity, -infinity, std::nan("")}) {
    spots.wall_shear = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("shear by walls is "), HasSubstr("from 0 to 4")));
  }
  spots.wall_shear = 0.7;
  spots.persistence = 0.3;
  EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("spread is 0.6 "), HasSubstr("persistence, 0.3")));
  spots = scenes::paper_spots();
  spots.spread = 0.6;
  EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("spread is 0.6 "), HasSubstr("no fixed volume")));
}

TEST(ParametersUnit, MobilityIsBoundedAndNeedsASpread) {
  SpotParameters spots = critical_spots();
  EXPECT_FALSE(spots.mobility.on());
  spots.mobility = {0.4, 1.0, 1.5};
  EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("towards what is mobile"), HasSubstr("need a spread, which is 0")));
  spots.spread = 0.6;
  for (const spot::Mobility& good : {spot::Mobility{0.4, 1.0, 1.5}, {0.01, 1e-3, 1e9}, {1.0, 0.0, 0.0}}) {
    spots.mobility = good;
    EXPECT_NO_THROW(spots.validate());
  }
  const auto refused = [&](const spot::Mobility& bad) {
    spots.mobility = bad;
    return refusal_of(spots);
  };
  for (const double bad : {-0.1, 0.0, 0.009, 1.1, infinity, -infinity, std::nan("")})
    EXPECT_THAT(refused({bad, 1.0, 1.5}), AllOf(HasSubstr("has not fallen is "), HasSubstr("from 0.01 to 1 (off)")));
  for (const double bad : {0.0, -1.0, infinity, std::nan("")}) {
    EXPECT_THAT(refused({0.4, bad, 1.5}), AllOf(HasSubstr("makes a packing mobile is "), HasSubstr("be positive")));
    EXPECT_THAT(refused({0.4, 1.0, bad}), AllOf(HasSubstr("what is mobile is "), HasSubstr("be positive")));
  }
}

TEST(ParametersUnit, APackingBecomesMobileAsItFalls) {
  const spot::Mobility mobility{0.4, 2.0, 1.5};
  EXPECT_DOUBLE_EQ(mobility.logarithm(0.0), std::log(0.4));
  EXPECT_DOUBLE_EQ(mobility.logarithm(1.0), std::log(1.0 - 0.6 * std::exp(-0.5)));
  EXPECT_DOUBLE_EQ(mobility.logarithm(1e4), 0.0);
}

TEST(ParametersUnit, FadeIsBoundedAndForBirthsThatFollowTheOutflow) {
  SpotParameters spots = scenes::paper_spots();
  EXPECT_EQ(spots.fade, 0.0);
  spots.fade = 0.25;
  EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("fade is 0.25 "), HasSubstr("births do not follow the outflow")));
  spots.holds_outflow = true;
  EXPECT_NO_THROW(spots.validate());
  for (const double bad : {-0.1, 2.1, infinity, -infinity, std::nan("")}) {
    spots.fade = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("fade is "), HasSubstr("from 0 (off) to 2")));
  }
}

TEST(ParametersUnit, NonaffineMotionIsUpToHalfTheFallAndHasALength) {
  SpotParameters spots = scenes::paper_spots();
  EXPECT_EQ(spots.nonaffine, 0.0);
  spots.nonaffine_length = 0.5;
  for (const double good : {0.0, 0.14, 0.5}) {
    spots.nonaffine = good;
    EXPECT_NO_THROW(spots.validate());
  }
  for (const double bad : {-0.1, 0.501, 1.0, infinity, -infinity, std::nan("")}) {
    spots.nonaffine = bad;
    EXPECT_THAT(refusal_of(spots), AllOf(HasSubstr("non-affine motion is "), HasSubstr("from 0 (off) to 0.5")));
  }
  spots.nonaffine = 0.1;
  for (const double bad : {0.0, -0.5, infinity, std::nan("")}) {
    spots.nonaffine_length = bad;
    EXPECT_THAT(refusal_of(spots),
                AllOf(HasSubstr("length of non-affine motion is "), HasSubstr("must be positive and finite")));
  }
}

TEST(ParametersUnit, DiffusionLengthOf2006) {
  SpotParameters spots = scenes::paper_spots();
  EXPECT_NEAR(spots.diffusion_length(), 1.156, 1e-12);
  spots.step_width = 0.675;
  EXPECT_NEAR(spots.diffusion_length(), 1.14, 1e-3);
}

TEST(ParametersUnit, StepWidthInvertsTheDiffusionLength) {
  for (const double height : {0.025, 0.1, 0.3}) {
    SpotParameters spots = scenes::paper_spots();
    spots.step_height = height;
    spots.step_width = spot::step_width_for(1.156, height);
    EXPECT_NEAR(spots.diffusion_length(), 1.156, 1e-14);
  }
  SpotParameters persistent = scenes::paper_spots();
  persistent.persistence = 0.6;
  persistent.step_width = spot::step_width_for(1.156, persistent.step_height, persistent.persistence);
  EXPECT_NEAR(persistent.step_width, 0.34, 1e-12);
  EXPECT_NEAR(persistent.diffusion_length(), 1.156, 1e-14);
  EXPECT_NEAR(spot::step_width_for(1.156, 0.1), 0.68, 1e-12);
  EXPECT_THAT(scenes::text_of<InvalidParameter>([] { spot::step_width_for(-1.0, 0.1); }),
              AllOf(HasSubstr("diffusion length"), HasSubstr("positive")));
  EXPECT_THAT(scenes::text_of<InvalidParameter>([] { spot::step_width_for(1.0, 0.0); }),
              AllOf(HasSubstr("step height"), HasSubstr("positive")));
}

/// 81.7 grains in a spot at a packing fraction of 0.579, and a spot that carries 0.205 grain volumes (2006).
TEST(ParametersUnit, SpotVolumeOf2006) {
  const double grain_volume = scenes::pi / 6.0;
  const double in_grains = scenes::paper_spots().spot_volume(0.579) / grain_volume;
  EXPECT_NEAR(in_grains, 0.205, 2e-3);
  EXPECT_NEAR(in_grains / scenes::paper_spots().influence, 81.7, 0.5);
}

TEST(ParametersUnit, MoveRateCarriesTheSpeed) {
  SpotParameters spots = scenes::paper_spots();
  EXPECT_DOUBLE_EQ(spots.move_rate(), 32.0);
  spots.step_height = 0.05;
  EXPECT_DOUBLE_EQ(spots.move_rate(), 64.0);
}

TEST(ParametersUnit, WaitingTimeIsOneOverTheMoveRate) {
  const SpotParameters spots = scenes::paper_spots();
  EXPECT_DOUBLE_EQ(spots.mean_waiting_time(), 0.1 / 3.2);
  EXPECT_DOUBLE_EQ(spots.mean_waiting_time() * spots.move_rate(), 1.0);
}

TEST(ParametersUnit, FixedVolumeOutOfRangeNamesTheWordAndTheBound) {
  EXPECT_EQ(SpotParameters().fixed_volume, 0.0);
  EXPECT_FALSE(SpotParameters().together);
  for (const double bad : {-1.0, infinity, std::nan("")}) {
    SpotParameters spots = scenes::paper_spots();
    spots.fixed_volume = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { spots.validate(); }),
                AllOf(HasSubstr("fixed volume is "), HasSubstr("zero (off) or positive")));
  }
}

TEST(ParametersUnit, MeanGrainVolumeIsThatOfGrainsUpToHalfAsWide) {
  SpotParameters spots = scenes::paper_spots();
  EXPECT_EQ(spots.mean_diameter(0.003), 0.003) << "equal grains, to the last bit";
  spots.fixed_volume = 77.0;
  const double equal = spots.missing_volume(0.003);
  for (const double good : {0.125, 0.5, 1.0}) {
    spots.mean_grain_volume = good;
    EXPECT_NO_THROW(spots.validate());
    EXPECT_DOUBLE_EQ(spots.missing_volume(0.003), equal * good);
    EXPECT_DOUBLE_EQ(spots.mean_diameter(0.003), 0.003 * std::cbrt(good));
  }
  for (const double bad : {-1.0, 0.0, 0.124, 1.001, infinity, std::nan("")}) {
    spots.mean_grain_volume = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { spots.validate(); }),
                AllOf(HasSubstr("mean grain volume is "), HasSubstr("from 0.125 to 1")));
  }
}

TEST(ParametersUnit, MomentumOutOfRangeNamesTheWordAndTheBound) {
  RelaxationParameters relaxation;
  for (const double good : {0.0, 0.5, 0.999}) {
    relaxation.momentum = good;
    EXPECT_NO_THROW(relaxation.validate());
  }
  for (const double bad : {-0.1, 1.0, 2.0, infinity, std::nan("")}) {
    relaxation.momentum = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { relaxation.validate(); }),
                AllOf(HasSubstr("relaxation momentum is "), HasSubstr("from 0 to below 1")));
  }
}

TEST(ParametersUnit, OverlapInContactOutOfRangeNamesTheWordAndTheBound) {
  RelaxationParameters relaxation;
  for (const double good : {0.0, 1.5e-3, 0.05}) {
    relaxation.contact_overlap = good;
    EXPECT_NO_THROW(relaxation.validate());
  }
  for (const double bad : {-1e-9, 0.0501, infinity, std::nan("")}) {
    relaxation.contact_overlap = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { relaxation.validate(); }),
                AllOf(HasSubstr("overlap in contact is "), HasSubstr("from 0 to 0.05")));
  }
}

TEST(ParametersUnit, ClosingOutOfRangeNamesTheWordAndTheBound) {
  RelaxationParameters relaxation;
  for (const auto& [gap, share] : {std::pair(0.0, 0.1), {4e-3, 0.0}, {4e-3, 0.1}, {0.05, 1.0}}) {
    relaxation.closing_gap = gap;
    relaxation.closing_share = share;
    EXPECT_NO_THROW(relaxation.validate()) << gap << ", " << share;
  }
  for (const double bad : {-1e-9, 0.0501, infinity, std::nan("")}) {
    relaxation.closing_gap = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { relaxation.validate(); }),
                AllOf(HasSubstr("gap that is closed is "), HasSubstr("from 0 (off) to 0.05")));
  }
  relaxation.closing_gap = 4e-3;
  for (const double bad : {-1e-9, 1.0001, infinity, std::nan("")}) {
    relaxation.closing_share = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { relaxation.validate(); }),
                AllOf(HasSubstr("share by which gaps are closed is "), HasSubstr("from 0 (off) to 1")));
  }
}

TEST(ParametersUnit, RelaxationDefaultsAreThoseOf2010) {
  const RelaxationParameters relaxation;
  EXPECT_EQ(relaxation.alpha, 0.8);
  EXPECT_EQ(relaxation.strength, RelaxationStrength::half_each);
  EXPECT_EQ(relaxation.shell, 1.0);
  EXPECT_EQ(relaxation.every, 1);
  EXPECT_EQ(relaxation.schedule, spot::RelaxationSchedule::moves);
  EXPECT_EQ(relaxation.momentum, 0.0);
  EXPECT_EQ(relaxation.contact_overlap, 0.0);
  EXPECT_EQ(relaxation.closing_gap, 0.0);
  EXPECT_EQ(relaxation.closing_share, 0.0);
}

TEST(ParametersUnit, RelaxationShares) {
  RelaxationParameters relaxation;
  EXPECT_DOUBLE_EQ(relaxation.pair_share(), 0.4);
  EXPECT_DOUBLE_EQ(relaxation.fixed_share(), 0.8);
  relaxation.strength = RelaxationStrength::full_each;
  EXPECT_DOUBLE_EQ(relaxation.pair_share(), 0.8);
  EXPECT_DOUBLE_EQ(relaxation.fixed_share(), 0.8);
}

TEST(ParametersUnit, RelaxationOutOfRangeNamesTheWordAndTheBound) {
  for (const double bad : {0.0, -0.1, infinity, std::nan("")}) {
    RelaxationParameters relaxation;
    relaxation.alpha = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { relaxation.validate(); }),
                AllOf(HasSubstr("relaxation alpha is "), HasSubstr("positive")));
  }
  RelaxationParameters strong;
  strong.alpha = 2.0;
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { strong.validate(); }),
              AllOf(HasSubstr("relaxation alpha is 2 "), HasSubstr("below 2")));
  for (const double bad : {-0.1, infinity, std::nan("")}) {
    RelaxationParameters relaxation;
    relaxation.shell = bad;
    EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { relaxation.validate(); }),
                AllOf(HasSubstr("relaxation shell is "), HasSubstr("zero or positive")));
  }
  RelaxationParameters rare;
  rare.every = -1;
  EXPECT_THAT(scenes::text_of<InvalidParameter>([&] { rare.validate(); }),
              AllOf(HasSubstr("relaxation interval is -1 "), HasSubstr("zero")));
  rare.every = 0;
  rare.shell = 0.0;
  EXPECT_NO_THROW(rare.validate());
}

}  // namespace
