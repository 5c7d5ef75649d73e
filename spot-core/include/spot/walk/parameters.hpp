// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/walk/influence_profile.hpp"
#include "spot/walk/injection.hpp"
#include "spot/walk/mobility.hpp"

namespace spot {

/// The five fitted numbers of the spot model and the seed.
/// "2006" is Rycroft, Bazant, Grest, Landry, Phys. Rev. E 73, 051306; "2010" is Rycroft, Wong, Bazant,
/// Powder Technology 200, 1-11. Lengths and times in the units of the deck.
struct SpotParameters {
  double radius = 0.0;       ///< R_s: grains with centres this close to the middle of a step move with it (length)
  double influence = 0.0;    ///< w: a step dr of the spot moves them by -w dr (2006, eq. 1)
  double step_width = 0.0;   ///< dx: a step goes by +-dx along x or along y (length)
  double step_height = 0.0;  ///< dz: and by dz upwards (length)
  double speed = 0.0;        ///< v_s: mean drift speed of a spot (length / time)
  Injection injection_rate = 0.0;  ///< nu_s: births per time at each outlet (1 / time)
  /// Births follow what leaves (OutflowControl), so that it is nu_s times the volume of a newborn spot.
  bool holds_outflow = false;
  /// c: what is asked for fades as the bed over an outlet runs out, by 1 - exp(-H / (c D)), H being the depth of the
  /// bed there and D the outlet's width (OutflowControl). 0: it does not.
  double fade = 0.0;
  /// N: a spot always carries the free volume of w N grains of mean volume, whatever volume it encloses, of which each
  /// grain's counts by its share of the influence (2010's fixed-volume weighting).
  /// 0: every grain it encloses moves by -w dr (2006).
  double fixed_volume = 0.0;
  /// The mean volume of the grains, over that of one of the reference diameter, which is that of the largest: from 1/8
  /// to 1. 1: grains are equal.
  double mean_grain_volume = 1.0;
  const InfluenceProfile* profile = InfluenceProfile::uniform;
  /// p: the chance that a step goes the way of the last one, without drawing (2006, section V: a persistent walk).
  double persistence = 0.0;
  /// c_0: spots climb at v_s where they take this share of the volume, and elsewhere in proportion to that share
  /// (DilationField). 0: they climb at v_s everywhere (2006).
  double dilation = 0.0;
  /// phi_c: the packing fraction of what flows, away from walls and where nothing is sheared (CriticalState). 0: spots
  /// carry the same volume all the way (2006).
  double critical_fraction = 0.0;
  /// Of climb, in which a spot leaves a share of its volume as large as that by which the packing is too dense
  /// (length).
  double exchange_length = 0.0;
  /// a: shear s for each length that grains fall (FlowField) lowers phi_c by a s, of itself (length). At most R_s / 3.
  double dilatancy = 0.0;
  /// s_1: from this strain for each length that grains fall on, spots exchange volume with the packing in full; where
  /// the strain is e, less (FlowField), (e / s_1)^2 of that. 0: in full everywhere (1 / length). At most 3 / R_s.
  double full_strain = 0.0;
  /// B: where the flow is sheared by s, free volume spreads as if the diffusion length were B / s (FlowField). 0: it is
  /// b_s everywhere (2006).
  double spread = 0.0;
  /// kappa: walls shear what falls between them by kappa / h, h being half_width(). 0: they don't.
  double wall_shear = 0.0;
  Mobility mobility = {};  ///< of the packing, by how far it has fallen
  /// beta: near the free surface, how much rather spots go where it is higher (2010's rule, FreeSurface). 0: they do
  /// not care (2006).
  double surface_exponent = 0.0;
  /// S: how much grains go against their neighbours, for what a move carries them down (NonaffineMotion). 0: they go
  /// the way of the spot (2006).
  double nonaffine = 0.0;
  double nonaffine_length = 0.0;  ///< l: of the fall in which a grain goes the same way (length)
  bool together = false;          ///< all spots step at the same times, every dz / v_s (2010's fixed time step)
  std::uint64_t seed = 1;

  /// Steps per time of a spot, v_s / dz; the waiting times are exponential, unless spots step together.
  double move_rate() const { return speed / step_height; }
  /// dz / v_s
  double mean_waiting_time() const { return step_height / speed; }
  /// The mean drift speed of the fastest spot there can be (length / time).
  double fastest() const;
  /// b_s = Var(x) / (2 z) of the walk. Half of the steps go along x, so Var(dx) = dx^2 / 2 a step; steps that are k
  /// apart have a correlation of p^k, which adds up to b_s = dx^2 / (4 dz) (1 + p) / (1 - p) (length).
  double diffusion_length() const {
    return step_width * step_width / (4.0 * step_height) * (1.0 + persistence) / (1.0 - persistence);
  }
  /// Of the uniform spot with the same volume (length).
  double equivalent_radius() const { return profile->equivalent_radius(radius); }
  /// V_s, the free volume that one spot carries through a packing of this packing fraction (length^3).
  double spot_volume(double packing_fraction) const;
  /// The grains' own volume that one spot takes out of the packing around it: that of w N grains, with a fixed volume,
  /// or of as many as it encloses at the packing fraction of flow (length^3). `diameter`: the reference diameter.
  double missing_volume(double diameter) const;
  /// Of a grain of mean volume, where the reference diameter is this (length).
  double mean_diameter(double diameter) const;

  /// Throws InvalidParameter that names the first number outside its range, or two that exclude each other.
  void validate() const;

 private:
  void validate_critical_state() const;
  void validate_fade() const;
  void validate_spread() const;
  void validate_nonaffine_motion() const;
};

/// dx that gives a diffusion length b_s with steps of height dz and persistence p: dx^2 = 4 b_s dz (1 - p) / (1 + p).
double step_width_for(double diffusion_length, double step_height, double persistence = 0.0);

/// Strength of the correction of two overlapping grains that both may move.
enum class RelaxationStrength {
  full_each,  ///< each grain moves alpha delta (as 2006 prints it)
  half_each,  ///< each grain moves alpha delta / 2 (2010)
};

/// When the time-ordered driver relaxes: after every k-th move of all spots (2006: k = 1), or as the schedules that
/// 2010 compares.
enum class RelaxationSchedule {
  moves,   ///< around every k-th move of all spots
  chance,  ///< around a move with probability 1/k
  spot,    ///< around every k-th move of each spot
  global,  ///< everywhere, every k mean waiting times of a spot
};

/// The soft-core relaxation of a packing (2006, section IV; 2010, section 2.3).
struct RelaxationParameters {
  double alpha = 0.8;                                           ///< share of an overlap taken back in one sweep
  RelaxationStrength strength = RelaxationStrength::half_each;  ///< who moves how far
  double shell = 1.0;  ///< grains farther than R_s + shell diameters from the step's middle are held fixed
  RelaxationSchedule schedule = RelaxationSchedule::moves;
  int every = 1;  ///< k of the schedule; 0: never
  /// Windowed driver: rms overlap, in diameters, that moves may build up between sweeps.
  double tolerance = 1.5e-3;
  /// Windowed driver: share of a grain's last correction that is added to the next. Overlaps that spread over many
  /// grains take many sweeps to go; with momentum they go in fewer.
  double momentum = 0.0;
  /// Overlap, in diameters, at which two grains are left alone: those that bear on each other overlap (Hertz), and are
  /// in contact. 2006 parts them until they only touch.
  double contact_overlap = 0.0;
  /// Gaps, in diameters, that are closed: weight closes those that moves open between grains that bear on each other.
  /// Two grains that are farther apart than they are left alone, but by less than this, are drawn together. 0: gaps
  /// stay (2006).
  double closing_gap = 0.0;
  double closing_share = 0.0;  ///< of what an overlap as large would be pushed apart by in a sweep; 0: gaps stay

  /// Share of the overlap by which a movable grain moves against another movable grain.
  double pair_share() const { return strength == RelaxationStrength::half_each ? 0.5 * alpha : alpha; }
  /// Share of the overlap by which a movable grain moves against a fixed one or a wall.
  double fixed_share() const { return alpha; }
  /// Of the centres of two grains that are not pushed apart.
  double distance_in_contact(double diameter) const { return (1.0 - contact_overlap) * diameter; }

  /// Throws InvalidParameter that names the first number outside its range.
  void validate() const;
};

}  // namespace spot
