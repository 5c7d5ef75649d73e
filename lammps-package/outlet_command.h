// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_OUTLET_COMMAND_H
#define SPOT_OUTLET_COMMAND_H

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "spot/geometry/beverloo.hpp"
#include "spot/geometry/container.hpp"
#include "spot/geometry/outlets.hpp"
#include "spot/walk/parameters.hpp"

class Words;

/// What a command says of the outlets of a silo: where they are (`orifice`, `slot`), how many spots enter (`injection`,
/// `outflow` or `beverloo`, with `hopper` above a cone), and when they open and close (`schedule`). All that reads
/// throws spot::InvalidParameter that names the offending word and what is allowed, or spot::InvalidContainer for
/// numbers that make no outlet.
class OutletCommand {
 public:
  void read_orifice(Words& words);
  void read_slot(Words& words);
  void read_injection(Words& words);
  void read_outflow(Words& words);
  void read_beverloo(Words& words);
  void read_hopper(Words& words);
  void read_schedule(Words& words);

  /// Throws spot::InvalidParameter if something is missing, or does not fit together; and as spot::Outlets does.
  void validate() const;

  /// From now on space repeats like this.
  void repeat(const spot::Periodic& periodic);

  /// In the order in which they were given.
  spot::Outlets outlets() const { return spot::Outlets(outlets_); }

  /// For Beverloo's law: how wide the silo is at the outlets, and which are the ends of hoppers. Throws
  /// spot::InvalidParameter, naming it, where 'hopper' has to know the half-angle at an outlet, and the walls don't
  /// tell. Up to then all bases are flat, but for a half-angle that was given, and wide.
  void look_at_walls(const spot::Container& walls);

  /// If there is one outlet, and it is round.
  std::optional<spot::Orifice> single_orifice() const;

  /// Births at each outlet. With `outflow` and `beverloo` they are as many as carry what is given, or predicted.
  spot::Injection injection(const spot::SpotParameters& spots, double diameter) const;

  /// The same where the factor of a `schedule` is 1.
  std::vector<double> births(const spot::SpotParameters& spots, double diameter) const;
  bool has_schedule(std::size_t outlet) const { return schedules_.count(outlet + 1) > 0; }

  /// The keyword that rates are given by.
  const char* rate_keyword() const;

  /// The names of LAMMPS variables whose values are factors on rates, by outlets from 0 on. The rates are for a value
  /// of 1 up to then.
  std::map<std::size_t, std::string> variables() const;

  /// Whether births are to follow what leaves: with `outflow` and `beverloo`.
  bool holds_outflow() const { return rates_.empty(); }

  /// By Beverloo's law, the grains that leave through each outlet per time; none without `beverloo`. Throws
  /// spot::InvalidParameter, naming the outlet, if one is too narrow for the law.
  std::vector<double> predicted_outflow(double diameter) const;

  /// What `hopper` makes of the outflow of an outlet (from 0 on), and for which half-angles that holds; empty without.
  std::string text_of_hopper(std::size_t outlet) const;

  /// Where Beverloo's law holds, in words.
  static std::string range_of_law();

  /// What is to be said of the outflow that is predicted: where the law is beyond its range. `depths`: of the bed above
  /// each outlet (length), if there is one.
  std::vector<std::string> doubts(double diameter, const std::vector<double>& depths = {}) const;

  /// As they were given; all numbers with all digits.
  std::string text_of_outlets() const;
  std::string text_of_rates() const;

 private:
  /// From a time on, an outlet has so many times its rate.
  struct Step {
    double time, factor;
  };

  /// `schedule`: a table, or a LAMMPS variable.
  struct Schedule {
    std::vector<Step> steps;
    std::string variable;
  };

  /// `hopper`: angles in degrees. Without a half-angle the walls tell it.
  struct Hopper {
    double of_material;
    std::optional<double> half_angle;
  };

  void add(const spot::Outlet& outlet, const std::string& text);
  void require_number_of(const char* keyword, std::size_t rates) const;
  std::optional<double> slope_at(std::size_t outlet) const;
  double hopper_factor(std::size_t outlet) const;
  void require_births() const;
  void add_doubts_of_hopper(std::size_t outlet, std::vector<std::string>& doubts) const;
  void add_doubts_of_silo(std::size_t outlet, double diameter, std::optional<double> depth,
                          std::vector<std::string>& doubts) const;

  std::vector<spot::Outlet> outlets_;
  std::vector<std::string> texts_;
  std::optional<spot::Orifice> last_orifice_;
  std::vector<double> rates_;      // births
  std::vector<double> outflow_;    // grains
  std::optional<double> gravity_;  // for Beverloo's law
  spot::BeverlooLaw law_;
  std::optional<Hopper> hopper_;
  std::vector<std::optional<double>> slopes_;  // of the walls at each outlet: tangents of half-angles
  std::vector<std::optional<double>> widths_;  // of the silo at each outlet, where walls are near
  std::map<std::size_t, Schedule> schedules_;  // by the number of the outlet, from 1 on
};

#endif
