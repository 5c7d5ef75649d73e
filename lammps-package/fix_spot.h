// SPDX-License-Identifier: GPL-2.0-only
#ifdef FIX_CLASS
// clang-format off
FixStyle(spot,FixSpot);
// clang-format on
#else

#ifndef LMP_FIX_SPOT_H
#define LMP_FIX_SPOT_H

#include "fix.h"

#include <cstdint>
#include <exception>
#include <memory>
#include <vector>

namespace spot {
struct Grain;
}

struct BoxWalls;
struct Delivery;

namespace LAMMPS_NS {

/// Drainage of dense grains by diffusing spots of free volume; see doc/fix_spot.rst.
class FixSpot : public Fix {
 public:
  FixSpot(class LAMMPS *, int, char **);
  ~FixSpot() override;

  int setmask() override;
  void init() override;
  int modify_param(int, char **) override;
  void setup(int) override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void end_of_step() override;
  void post_run() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double compute_vector(int) override;
  double memory_usage() override;

  // Of the output per atom, which goes along with the atoms.
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;

 private:
  struct Model;  // what comes from spot-core stays out of this header
  std::unique_ptr<Model> model;

  void check_run();
  void dry_run();
  void write_scene();
  void check_grains();
  void measure_grains();
  void choose_window();
  void go_on_with_saved_window();
  void check_other_fixes();
  void check_integrators() const;
  void name_unused_forces();
  void tell_predicted_outflow();
  std::vector<double> bed_above_outlets() const;
  void warn_of_held_spots() const;
  void check_variables() const;
  void follow_variables();
  void make_container();
  void make_drainage();
  double extent() const;
  void read_period();
  void check_box();
  void require_walls_or_period(const BoxWalls &) const;
  void find_hashes();
  std::uint64_t hash_of_lammps(int) const;
  void remember_grains();
  bool somebody_changed_grains();
  void take_changes();
  spot::Grain grain_of_lammps(int) const;
  std::vector<spot::Grain> grains_of_lammps() const;
  double in_box(double, int) const;
  void count_crossings(int, int, double);
  void move_grain(int, const double *, bool);
  void write_grains(const std::vector<spot::Grain> &, bool);
  std::vector<Delivery> deliver_grains(const std::vector<spot::Grain> &, bool) const;
  void offer_output_per_atom();
  void add_moves_received();
  void put_back(const std::vector<spot::Grain> &);
  bool was_put_back(std::int64_t) const;
  void count_at_outlets(const std::vector<spot::Grain> &);
  void tell_all_who_leaves();
  int local_index(std::int64_t) const;
  void list_spots();
  double largest_overlap() const;
  double mean_outflow() const;
  [[noreturn]] void fail(const std::exception &) const;
};

}  // namespace LAMMPS_NS

#endif
#endif
