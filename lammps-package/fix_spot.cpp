// SPDX-License-Identifier: GPL-2.0-only
#include "lammps_headers.h"

#include "fix_spot.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "input.h"
#include "memory.h"
#include "modify.h"
#include "region.h"
#include "update.h"
#include "utils.h"
#include "variable.h"

#include "dry_run.h"
#include "find_region.h"
#include "grain_delivery.h"
#include "grain_sizes.h"
#include "mpi_communicator.h"
#include "recirculation.h"
#include "region_container.h"
#include "saved_run.h"
#include "scene_file.h"
#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"
#include "spot/drivers/time_ordered_drainage.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/silos.hpp"
#include "spot_command.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <fstream>
#include <mutex>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace FixConst;
using spot::message;

namespace {

/// Place in the global vector of the grains that have left through the first outlet; those of the others follow.
constexpr int FIRST_OF_OUTLETS = 8;

/// Columns of the spots in dump local.
enum SpotColumn { ID, X, Y, Z, STEPS, VOLUME, COLUMNS };

/// Columns of the output per atom, after the displacement along x, y and z.
enum GrainColumn { MOVES = 3, PASSAGES, GRAIN_COLUMNS };

/// What a grain has in a restart file: the number of these, its columns, and a checksum.
constexpr int GRAIN_RECORD = 1 + GRAIN_COLUMNS + 1;

/// Of a grain's columns and whose they are; a whole number that a double holds.
double checksum_of(tagint grain, const double *columns) {
  double all[1 + GRAIN_COLUMNS] = {static_cast<double>(grain)};
  std::copy_n(columns, +GRAIN_COLUMNS, all + 1);
  return static_cast<double>(spot::checksum(reinterpret_cast<const char *>(all), sizeof all) >> 12);
}

std::uint64_t bits_of(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

spot::Vector3 snapped(const spot::Vector3 &position, const spot::Quantum &quantum) {
  return {quantum.snap(position.x()), quantum.snap(position.y()), quantum.snap(position.z())};
}

/// Of all that a grain is, its position to the quantum, in the cell: LAMMPS rounds positions when it balances its
/// ranks.
std::uint64_t hash_of(const spot::Grain &grain, double radius, const spot::Quantum &quantum,
                      const spot::Periodic &periodic) {
  std::uint64_t hash = static_cast<std::uint64_t>(grain.id) * 2 + (grain.held ? 1 : 0);
  const auto mix = [&hash](double value) {
    hash = (hash ^ (hash >> 29) ^ bits_of(value + 0.0)) * 0x9e3779b97f4a7c15u;  // no negative zero
  };
  const spot::Vector3 position = periodic.wrap(snapped(grain.position, quantum));
  for (const double at : position) mix(at);
  mix(radius);
  return hash ^ (hash >> 32);
}

/// Of grains: their number, and their hashes in two halves, so that sums over ranks don't overflow.
using HashSums = std::array<std::int64_t, 3>;

void count_hash(HashSums &sums, std::uint64_t hash, int sign) {
  sums[0] += sign;
  sums[1] += sign * static_cast<std::int64_t>(hash & 0xffffffffu);
  sums[2] += sign * static_cast<std::int64_t>(hash >> 32);
}

void add(HashSums &sums, const HashSums &others) {
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += others[k];
}

/// What one thread adds up, in a cache line of its own.
struct alignas(64) HashSumsOfThread {
  HashSums sums{};
};

std::string lost(std::int64_t grain) {
  return message("grain ", grain, " was lost by LAMMPS: make the simulation box larger");
}

/// Seen from above. The silo is inside.
double area_of_box(const Domain &domain) {
  return (domain.boxhi[0] - domain.boxlo[0]) * (domain.boxhi[1] - domain.boxlo[1]);
}

/// A variable of this name, with a file's, asks for a dry run.
constexpr const char *DRY_RUN = "spot_dry_run";

enum BoundaryKind { PERIODIC = 0, FIXED = 1 };  // as in domain.h

/// Where LAMMPS keeps the grain of an ID: a table, or a map if the IDs leave large gaps.
class LocalIndices {
 public:
  void assign(const tagint *tags, int n) {
    map_.clear();
    table_.clear();
    if (n == 0) return;
    const auto [low, high] = std::minmax_element(tags, tags + n);
    lowest_ = *low;
    if (*high - *low < 16 * static_cast<bigint>(n)) table_.assign(*high - *low + 1, -1);
    for (int i = 0; i < n; ++i) {
      if (table_.empty())
        map_[tags[i]] = i;
      else
        table_[tags[i] - lowest_] = i;
    }
  }

  /// -1 if there is no such grain.
  int operator[](tagint tag) const {
    if (!table_.empty()) {
      const auto place = static_cast<std::size_t>(tag - lowest_);
      return tag >= lowest_ && place < table_.size() ? table_[place] : -1;
    }
    const auto found = map_.find(tag);
    return found == map_.end() ? -1 : found->second;
  }

  std::size_t memory() const {
    constexpr std::size_t node = sizeof(void *) + sizeof(std::pair<const tagint, int>);
    return spot::bytes_in(table_) + map_.size() * node + map_.bucket_count() * sizeof(void *);
  }

 private:
  tagint lowest_ = 0;
  std::vector<int> table_;
  std::unordered_map<tagint, int> map_;
};

}  // namespace

struct FixSpot::Model {
  /// How many grains had left, on all ranks, by a time.
  struct Drained {
    std::int64_t windows, grains;
  };

  explicit Model(MPI_Comm world) : ranks(std::make_shared<MpiCommunicator>(world)) {}

  SpotCommand command;
  std::shared_ptr<MpiCommunicator> ranks;
  std::optional<SavedRun> saved;  // from a restart file, until the drainage goes on from it
  GrainSizes sizes;
  double drained_mass = 0.0;
  std::vector<std::int64_t> drained_at;  // grains that have left through each outlet, as far as this rank knows
  double overlap_after_run = 0.0;
  std::shared_ptr<const spot::Container> container;
  spot::Periodic cell;  // that of the command, in quanta
  std::unique_ptr<spot::Drainage> drainage;
  std::int64_t windows = 0;  // done since the fix was made; the clock of the spots
  double window = 0.0;       // in time units; until the first step only what it would be
  int windows_per_step = 1;
  std::optional<HashSums> remembered;  // of the grains of this rank as the fix has left them
  HashSums found{};                    // as it has found them since
  bool named_unused_forces = false, told_outflow = false;
  LocalIndices local;
  std::unique_ptr<spot::Recirculation> recirculation;  // if grains go round
  std::vector<Delivery> put_back;  // in the last step, on all ranks, in increasing order of IDs; where they are now
  std::vector<tagint> leaving;     // drained grains that LAMMPS still holds, on whichever rank
  std::deque<Drained> drained = {{0, 0}};  // after each of the last command.average steps, and before
  std::vector<double> spots;               // SpotColumn values, a row a spot
  std::vector<double *> rows;

  /// That spots have left in the packing, less what they took up, in grains.
  double volume_left() {
    const double parts = static_cast<double>(drainage->total().volume_left) / spot::CriticalState::volume_parts;
    return parts * command.spots.influence * command.spots.fixed_volume;
  }
};

/* ---------------------------------------------------------------------- */

FixSpot::FixSpot(LAMMPS *instance, int narg, char **arg)
    : Fix(instance, narg, arg), model(std::make_unique<Model>(world)) {
  time_integrate = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
  nevery = 1;
  dynamic_group_allow = 0;
  restart_global = 1;

  vector_flag = 1;
  global_freq = 1;
  extvector = 0;

  local_flag = 1;
  size_local_cols = COLUMNS;
  size_local_rows = 0;
  local_freq = 1;

  if (!atom->radius_flag || !atom->rmass_flag)
    error->all(FLERR, std::string("fix spot needs grains with a radius: use atom_style sphere"));
  if (!atom->tag_enable)
    error->all(FLERR, std::string("fix spot needs grains with IDs: leave out 'atom_modify id no'"));
  if (lmp->kokkos) error->all(FLERR, std::string("fix spot does not work with the KOKKOS package"));
  if (domain->dimension != 3) error->all(FLERR, std::string("fix spot needs a simulation in 3 dimensions"));
  try {
    model->command = parse_spot_command(std::vector<std::string>(arg + 3, arg + narg));
  } catch (const spot::Error &e) {
    error->all(FLERR, message("Illegal fix spot command: ", e.what()));
  }
  model->drained_at.assign(model->command.outlets.outlets().size(), 0);
  size_vector = FIRST_OF_OUTLETS + static_cast<int>(model->drained_at.size());
  if (model->command.per_atom) offer_output_per_atom();
}

FixSpot::~FixSpot() {
  if (!peratom_flag) return;
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(array_atom);
}

int FixSpot::modify_param(int narg, char **arg) {
  try {
    const std::size_t read = modify_spot_command(model->command, {arg, arg + narg});
    if (model->drainage) model->drainage->set_threads(model->command.threads);
    return static_cast<int>(read);
  } catch (const spot::Error &e) {
    error->all(FLERR, message("Illegal fix_modify command for fix spot: ", e.what()));
  }
}

int FixSpot::setmask() { return INITIAL_INTEGRATE | PRE_EXCHANGE | END_OF_STEP; }

/* ----------------------------------------------------------------------
   checks before every run
------------------------------------------------------------------------- */

void FixSpot::check_run() {
  if (update->whichflag == 2) error->all(FLERR, std::string("fix spot does not work with minimize"));
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, std::string("fix spot does not work with run_style respa"));
  if (domain->triclinic) error->all(FLERR, std::string("fix spot does not work in a triclinic box"));
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int kind = domain->boundary[axis][side];
      if (kind == FIXED || (kind == PERIODIC && axis < 2)) continue;
      error->all(FLERR, message("fix spot needs 'boundary f f f', or p along x or y where no walls stand: the ",
                                side ? "upper" : "lower", " boundary in ", "xyz"[axis], " is ",
                                kind == PERIODIC ? "periodic" : "shrink-wrapped"));
    }
  if ((domain->xperiodic || domain->yperiodic) && (domain->box_change_size || domain->box_change_shape))
    error->all(FLERR, std::string("fix spot does not work in a periodic simulation box that changes in a run"));
}

/// Before every run: between two of them the box may have been changed.
void FixSpot::read_period() {
  std::optional<spot::Interval> cell[2];
  for (int axis = 0; axis < 2; ++axis)
    if (domain->periodicity[axis]) cell[axis] = spot::Interval{domain->boxlo[axis], domain->boxhi[axis]};
  const spot::Periodic periodic(cell[0], cell[1]);
  if (model->drainage && periodic != model->command.periodic)
    throw spot::InvalidContainer("the simulation box repeats otherwise than in the last run: give the fix another ID");
  model->command.periodic = periodic;
  model->command.outlets.repeat(periodic);
}

/// A window that the command leaves open follows from the timestep of the first run that has steps.
void FixSpot::choose_window() {
  SpotCommand &command = model->command;
  const bool steps = update->nsteps > 0;
  double window = command.window.value_or(update->dt);
  if (!command.window && !*command.time_ordered) {
    const double longest =
        spot::longest_window(command.spots, model->sizes.mean(), model->sizes.largest, command.outlets.outlets());
    window = update->dt / std::ceil(update->dt / longest - 1e-9);
  }
  if (window != model->window) model->drainage.reset();  // in which there have been no windows yet
  model->window = window;
  if (!steps) return;
  command.window = window;
  const double ratio = update->dt / window;
  constexpr double most = 1e9;  // an int holds the number of windows in a step
  if (ratio < 0.5 || ratio > most || std::abs(ratio - std::round(ratio)) > 1e-6 * ratio)
    error->all(
        FLERR,
        message("fix spot: timestep ", update->dt, " must be a whole number of windows of ", window, ", from 1 to ",
                most, model->windows == 0 ? "" : "; the clock of the spots counts in them since the first run"));
  model->windows_per_step = static_cast<int>(std::lround(ratio));
}

void FixSpot::check_other_fixes() {
  int spots = 0;
  for (int i = 0; i < modify->nfix; ++i)
    if (strcmp(modify->fix[i]->style, style) == 0) ++spots;
  if (spots > 1) error->all(FLERR, std::string("only one fix spot can be in use"));
  check_integrators();
  if (!model->named_unused_forces) name_unused_forces();
}

/// Nobody else may move the grains.
void FixSpot::check_integrators() const {
  for (int i = 0; i < modify->nfix; ++i) {
    const Fix &other = *modify->fix[i];
    if (!other.time_integrate || &other == this) continue;
    std::int64_t shared = 0;
    for (int k = 0; k < atom->nlocal; ++k)
      if ((atom->mask[k] & groupbit) != 0 && (atom->mask[k] & other.groupbit) != 0) ++shared;
    shared = model->ranks->sum(shared);
    if (shared > 0 || other.igroup == 0 || other.igroup == igroup)
      error->all(FLERR, message("fix ", other.id, " (", other.style, ") moves ", shared, " of the grains that fix ", id,
                                " (spot) moves: leave it out, or 'unfix ", other.id, "'"));
  }
}

/// What a deck for DEM brings along, which takes time and changes nothing.
void FixSpot::name_unused_forces() {
  model->named_unused_forces = true;
  std::string unused;
  const auto add = [&unused](const std::string &what) { unused += (unused.empty() ? "" : ", ") + what; };
  if (force->pair && strcmp(force->pair_style, "none") != 0 && strcmp(force->pair_style, "zero") != 0)
    add(message("pair style ", force->pair_style));
  for (int i = 0; i < modify->nfix; ++i)
    if ((modify->fmask[i] & POST_FORCE) != 0)
      add(message("fix ", modify->fix[i]->id, " (", modify->fix[i]->style, ")"));
  if (!unused.empty() && comm->me == 0)
    error->warning(FLERR, message("fix spot needs no forces; unused, but for their time: ", unused));
}

void FixSpot::check_grains() {
  if (atom->natoms == 0) {
    // A silo that ran empty is no error, but without a single grain there is no diameter to start from.
    if (!model->sizes.known()) error->all(FLERR, std::string("fix spot: there are no grains"));
    return;
  }
  if (!model->sizes.known()) measure_grains();
  try {
    for (int i = 0; i < atom->nlocal; ++i) model->sizes.require(atom->tag[i], atom->radius[i]);
  } catch (const spot::InvalidPacking &e) {
    error->one(FLERR, message("fix spot: ", e.what()));
  }
  // LAMMPS would stop a little later, too, but without naming the grain.
  for (int i = 0; i < atom->nlocal; ++i)
    if (!std::isfinite(atom->x[i][0]) || !std::isfinite(atom->x[i][1]) || !std::isfinite(atom->x[i][2]))
      error->one(FLERR, message("fix spot: position of grain ", atom->tag[i], " is not finite"));
}

/// Once: what comes later must fit.
void FixSpot::measure_grains() {
  std::vector<bool> moves(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i) moves[i] = (atom->mask[i] & groupbit) != 0;
  const GrainSizes sizes = measure_sizes({atom->radius, atom->radius + atom->nlocal}, moves, *model->ranks);
  if (!sizes.known()) error->all(FLERR, std::string("fix spot: the grains have no diameter; use 'set ... diameter'"));
  model->sizes = sizes;
  if (!sizes.equal() && comm->me == 0)
    utils::logmesg(lmp, message("fix spot: grains of unequal size, up to ", sizes.largest,
                                " wide; one of mean volume, d, is ", sizes.mean(), " wide\n"));
}

void FixSpot::init() {
  check_run();
  check_other_fixes();
  check_grains();
  // Without a pair style nobody else asks for a communication cutoff, and LAMMPS would warn that it is zero.
  comm->cutghostuser = std::max(comm->cutghostuser, 2.0 * model->sizes.largest);
  try {
    read_period();
    model->command.resolve(model->sizes.mean(), model->sizes.mean_volume);
    check_box();
    make_container();
    model->command.outlets.look_at_walls(*model->container);
    model->command.resolve_rates(model->sizes.mean(), model->sizes.mean_volume);
    model->command.require_grains_between_spots(area_of_box(*domain), model->sizes.mean());
    tell_predicted_outflow();
    check_variables();
    if (*model->command.time_ordered && comm->nprocs > 1)
      throw spot::InvalidParameter(message("relaxation in the order of time runs on 1 MPI rank, not on ", comm->nprocs,
                                           ": use 'accuracy normal', or 'relax tol' with a tolerance"));
    if (model->saved) go_on_with_saved_window();
    choose_window();
    if (model->command.recirculation)
      model->recirculation = std::make_unique<spot::Recirculation>(
          model->command.spots.seed, inlet_of(model->command, *domain), model->container, model->sizes.largest);
    if (model->saved) require_same_settings(*model->saved, model->command.settings());
    if (input->variable->find(DRY_RUN) >= 0) dry_run();
  } catch (const spot::Error &e) {
    error->all(FLERR, message("fix spot: ", e.what()));
  }
}

/// Instead of the run: here, before LAMMPS opens the files of dumps and so empties those of a run before.
void FixSpot::dry_run() {
  if (comm->nprocs > 1)
    error->all(FLERR, message("fix spot: a dry run, with the variable ", DRY_RUN, ", is for 1 MPI rank"));
  const std::string path = input->variable->retrieve(DRY_RUN);
  if (!model->drainage) make_drainage();
  const std::vector<spot::Grain> grains = model->drainage->grains();
  const double *low = domain->boxlo, *high = domain->boxhi;
  const std::string text = describe({model->command,
                                     model->container,
                                     grains,
                                     model->sizes.mean(),
                                     model->sizes.largest,
                                     model->window,
                                     update->dt,
                                     update->nsteps,
                                     update->unit_style,
                                     static_cast<std::size_t>(memory_usage()),
                                     {low[0], low[1], low[2]},
                                     {high[0], high[1], high[2]}});
  std::ofstream file(path);
  if (!(file << text).flush()) error->all(FLERR, message("fix spot: cannot write ", path));
  utils::logmesg(lmp, message("fix spot: a dry run, written to ", path, "\n"));
  error->done(0);
}

/// Once: what 'beverloo' has made of the outlets, and where not to trust it.
void FixSpot::tell_predicted_outflow() {
  const OutletCommand &outlets = model->command.outlets;
  const std::vector<double> outflow = outlets.predicted_outflow(model->sizes.mean());
  if (outflow.empty() || model->told_outflow) return;
  model->told_outflow = true;
  const std::vector<double> depths = bed_above_outlets();
  if (comm->me != 0) return;
  const spot::Outlets all = outlets.outlets();
  const std::vector<double> births = model->command.births(model->sizes.mean());
  for (std::size_t k = 0; k < outflow.size(); ++k) {
    const std::string hopper = outlets.text_of_hopper(k);
    utils::logmesg(
        lmp, message("fix spot: Beverloo's law predicts an outflow of ", outflow[k], " grains per time through the ",
                     all[k].name(), ", by ", births[k], " births of spots per time",
                     outlets.has_schedule(k) ? ", where the factor of its schedule is 1\n" : "\n",
                     hopper.empty() ? "" : "fix spot: this is " + hopper + "\n"));
  }
  utils::logmesg(lmp, "fix spot: " + OutletCommand::range_of_law() + "\n");
  for (const std::string &doubt : outlets.doubts(model->sizes.largest, depths))
    error->warning(FLERR, "fix spot: " + doubt);
}

/// The height of the highest grain over each outlet (length); nothing before there are grains.
std::vector<double> FixSpot::bed_above_outlets() const {
  const spot::Container &container = *model->container;
  const double base = container.outlets().height(), radius = 0.5 * model->sizes.largest;
  std::vector<double> depths(container.outlets().size(), 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const spot::Vector3 at(atom->x[i][0], atom->x[i][1], atom->x[i][2]);
    if (!container.is_over_outlet(at)) continue;
    double &depth = depths[container.nearest_outlet_index(at)];
    depth = std::max(depth, at.z() + radius - base);
  }
  for (double &depth : depths) depth = -depth;
  depths = model->ranks->least(depths);
  for (double &depth : depths) depth = -depth;
  return atom->natoms == 0 ? std::vector<double>() : depths;
}

/// A variable may have been deleted, or defined again, since the last run.
void FixSpot::check_variables() const {
  for (const auto &[outlet, name] : model->command.outlets.variables()) {
    const int variable = input->variable->find(name.c_str());
    const bool exists = variable >= 0;
    if (exists && input->variable->equalstyle(variable)) continue;
    throw spot::InvalidParameter(message("variable '", name, "' of 'schedule ", outlet + 1, " v_", name, "' ",
                                         exists ? "is not equal-style" : "does not exist",
                                         ": it must be defined by 'variable ", name, " equal ...'"));
  }
}

/// Once at the start of each step. LAMMPS counts a step before it is done: for a moment it has to say when it begins.
void FixSpot::follow_variables() {
  const auto variables = model->command.outlets.variables();
  if (variables.empty()) return;
  --update->ntimestep;
  modify->clearstep_compute();
  std::vector<double> factors;
  for (const auto &[outlet, name] : variables)
    factors.push_back(input->variable->compute_equal(input->variable->find(name.c_str())));
  modify->addstep_compute(update->ntimestep + 1);
  ++update->ntimestep;
  // All ranks need the same bits, and a sum over ranks may round otherwise on each.
  MPI_Bcast(factors.data(), static_cast<int>(factors.size()), MPI_DOUBLE, 0, world);
  const double now = static_cast<double>(model->windows) * model->window;
  auto factor = factors.begin();
  for (const auto &[outlet, name] : variables) {
    const double value = *factor++;
    const auto refuse = [&, of = outlet, variable = name](const std::string &why) {
      error->all(FLERR, message("fix spot: variable '", variable, "', the factor on the rate of outlet ", of + 1,
                                ", is ", value, " at step ", update->ntimestep - 1, ": ", why));
    };
    if (!(value >= 0.0) || !std::isfinite(value)) refuse("it must be finite, and 0 or more");
    const double births = value * model->command.spots.injection_rate.at(outlet, 0.0);
    const double most = model->command.most_births(area_of_box(*domain), model->sizes.mean());
    if (births > most)
      refuse(message("it must be at most ", value * (most / births),
                     ", with which spots carry away all grains that fit into the simulation box"));
    try {
      model->drainage->change_rate(outlet, now, births);
    } catch (const spot::InvalidParameter &e) {
      refuse(e.what());
    }
  }
}

/// Of one rank, maybe: all others have to stop, too.
void FixSpot::fail(const std::exception &e) const {
  const std::string text = message("fix spot: ", e.what());
  if (comm->nprocs > 1) error->one(FLERR, text);
  error->all(FLERR, text);
}

/// Along each axis of the two that are horizontal, and not both.
void FixSpot::require_walls_or_period(const BoxWalls &box) const {
  const std::optional<spot::Interval> walls[] = {box.x, box.y};
  for (int axis = 0; axis < 2; ++axis) {
    if (walls[axis].has_value() != model->command.periodic.along(axis)) continue;
    const char name = "xy"[axis];
    throw spot::InvalidContainer(walls[axis]
                                     ? message("'box' has walls along ", name,
                                               ", where the simulation box is periodic: write NULL NULL ",
                                               "for them, or use 'boundary f'")
                                     : message("'box' has NULL NULL for walls along ", name,
                                               ", but the simulation box is not periodic there: use 'boundary p'"));
  }
}

/// LAMMPS drops what is outside its box, so the walls and the outlet must not be.
void FixSpot::check_box() {
  const auto require = [this](char axis, double low, double high) {
    const int k = axis - 'x';
    const double slack = 1e-9 * (domain->boxhi[k] - domain->boxlo[k]);
    if (low < domain->boxlo[k] - slack || high > domain->boxhi[k] + slack)
      throw spot::InvalidContainer(message("the walls along ", axis, ", at ", low, " and ", high,
                                           ", are not within the simulation box, from ", domain->boxlo[k], " to ",
                                           domain->boxhi[k]));
  };
  const SpotCommand &command = model->command;
  if (const auto *box = std::get_if<BoxWalls>(&command.walls)) {
    require_walls_or_period(*box);
    if (box->x) require('x', box->x->low, box->x->high);
    if (box->y) require('y', box->y->low, box->y->high);
  } else if (command.periodic.any() && command.uses_region()) {
    throw spot::InvalidContainer(
        "walls of a region cannot repeat, but the simulation box is periodic: use 'box' with NULL NULL along periodic "
        "axes, 'walls' or 'cylinder'");
  } else if (const auto *cylinder = std::get_if<CylinderWalls>(&command.walls)) {
    require('x', cylinder->x - cylinder->radius, cylinder->x + cylinder->radius);
    require('y', cylinder->y - cylinder->radius, cylinder->y + cylinder->radius);
  } else if (const auto *shaped = std::get_if<ShapedWalls>(&command.walls)) {
    // Along periodic axes each shape is asked whether it can repeat.
    if (!command.periodic.along(0)) require('x', shaped->low().x(), shaped->high().x());
    if (!command.periodic.along(1)) require('y', shaped->low().y(), shaped->high().y());
  }
  if (*command.outlet < domain->boxlo[2])
    throw spot::InvalidContainer(message("outlet is at z = ", *command.outlet, " but the simulation box begins at ",
                                         domain->boxlo[2], ": grains would be lost before they are counted"));
}

/// For every run anew: a region can have been deleted or defined again since the last one.
void FixSpot::make_container() {
  const SpotCommand &command = model->command;
  const spot::SpotBuffers buffers{*command.side_buffer, *command.base_buffer};
  const spot::Outlets outlets = command.outlets.outlets();
  if (const auto *box = std::get_if<BoxWalls>(&command.walls)) {
    model->container = spot::box_silo(box->x, box->y, command.periodic, outlets, buffers);
  } else if (const auto *cylinder = std::get_if<CylinderWalls>(&command.walls)) {
    model->container =
        spot::cylinder_silo(cylinder->x, cylinder->y, cylinder->radius, outlets, buffers, command.periodic);
  } else if (const auto *shaped = std::get_if<ShapedWalls>(&command.walls)) {
    model->container = std::make_shared<spot::ShapedContainer>(
        shaped->solid(command.periodic), outlets.repeated(command.periodic), buffers, command.periodic);
  } else {
    const std::string &name = std::get<RegionWalls>(command.walls).id;
    Region *region = find_region(*domain, name, 0);
    if (!region) throw spot::InvalidContainer(message("region '", name, "' does not exist"));
    if (region->varshape || region->dynamic_check())
      throw spot::InvalidContainer(message("region '", name, "' moves or changes shape, which is not supported"));
    model->container = std::make_shared<RegionContainer>(region, *domain, *command.outlets.single_orifice(), buffers);
  }
}

/* ----------------------------------------------------------------------
   grains between LAMMPS' arrays and the packing
------------------------------------------------------------------------- */

spot::Grain FixSpot::grain_of_lammps(int i) const {
  return {atom->tag[i],
          {atom->x[i][0], atom->x[i][1], atom->x[i][2]},
          (atom->mask[i] & groupbit) == 0,
          model->sizes.radius(atom->radius[i])};
}

std::vector<spot::Grain> FixSpot::grains_of_lammps() const {
  std::vector<spot::Grain> grains;
  grains.reserve(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i) grains.push_back(grain_of_lammps(i));
  std::sort(grains.begin(), grains.end(), [](const spot::Grain &a, const spot::Grain &b) { return a.id < b.id; });
  return grains;
}

/// No coordinate is ever larger.
double FixSpot::extent() const {
  double extent = std::abs(*model->command.outlet) + model->sizes.largest;
  for (int axis = 0; axis < 3; ++axis)
    extent = std::max({extent, std::abs(domain->boxlo[axis]), std::abs(domain->boxhi[axis])});
  return extent;
}

/// From the grains of LAMMPS, or from what a restart file says.
void FixSpot::make_drainage() {
  const SpotCommand &command = model->command;
  const spot::DrainageLimits limits{*command.outlet, command.largest_overlap};
  const double diameter = model->sizes.largest;
  const auto time_ordered = [&](auto &&...start) {
    model->drainage = std::make_unique<spot::TimeOrderedDrainage>(command.spots, command.relaxation, limits,
                                                                  model->container, start...);
  };
  const auto windowed = [&](const auto &start) {
    model->drainage = std::make_unique<spot::WindowedDrainage>(command.spots, command.relaxation, limits, model->window,
                                                               command.threads, model->container, diameter, extent(),
                                                               start, model->ranks);
  };
  if (model->saved) {
    const SavedRun run = std::move(*model->saved);
    model->saved.reset();
    *command.time_ordered ? time_ordered(diameter, extent(), run.parts.at(0)) : windowed(run.parts);
  } else {
    const std::vector<spot::Grain> grains = grains_of_lammps();
    *command.time_ordered ? time_ordered(spot::Packing(diameter, extent(), grains, command.periodic))
                          : windowed(grains);
  }
  model->cell = command.periodic.on(model->drainage->quantum());
}

void FixSpot::setup(int) {
  try {
    const bool goes_on = model->drainage || model->saved;
    if (!model->drainage) {
      make_drainage();
      if (peratom_flag) model->drainage->count_moves_received();
    }
    if (goes_on) {
      if (model->command.uses_region()) model->drainage->replace_container(model->container);
      if (somebody_changed_grains()) take_changes();
      model->drainage->require_inside();
    } else {
      find_hashes();
    }
    write_grains({}, false);
    remember_grains();
    if (model->command.scene) write_scene();
  } catch (const spot::Error &e) {
    fail(e);
  }
  list_spots();
}

/// For the analysis of the dumps, again at the start of each run, in which the timestep may be another one.
void FixSpot::write_scene() {
  const SceneCommand &scene = *model->command.scene;
  const std::int64_t drained = model->recirculation ? 0 : model->drainage->total().drained;
  const double clock = static_cast<double>(model->windows) * model->window;
  const SceneOfDumps dumps{model->command,
                           model->sizes.mean(),
                           scene.gravity,
                           update->dt,
                           static_cast<double>(update->ntimestep) * update->dt - clock,
                           static_cast<std::int64_t>(atom->natoms) + drained};
  std::int64_t failed = 0;
  if (comm->me == 0) {
    std::ofstream file(scene.file);
    if (!(file << describe(dumps)).flush()) failed = 1;
  }
  if (model->ranks->sum(failed) > 0)
    throw spot::InvalidParameter(message("'scene' cannot write ", scene.file, ": its folder must be there"));
}

/// One pass over this rank's grains, in the order in which LAMMPS has them.
void FixSpot::find_hashes() {
  model->found = {};
  std::mutex adding;
  model->drainage->share_out(atom->nlocal, [&](std::size_t first, std::size_t last) {
    HashSums own{};
    for (int i = static_cast<int>(first); i < static_cast<int>(last); ++i) count_hash(own, hash_of_lammps(i), 1);
    const std::lock_guard<std::mutex> lock(adding);
    add(model->found, own);
  });
}

std::uint64_t FixSpot::hash_of_lammps(int i) const {
  return hash_of(grain_of_lammps(i), atom->radius[i], model->drainage->quantum(), model->cell);
}

/// After the fix has written what it knows, and has added it to what it had found. Those that leave are LAMMPS' until
/// it drops them.
void FixSpot::remember_grains() {
  model->drainage->forget_moved();
  model->remembered = model->found;
  for (const tagint grain : model->leaving) count_hash(*model->remembered, hash_of_lammps(local_index(grain)), -1);
}

/// Does LAMMPS still have the grains, on whichever ranks, as the fix has left them? Sums of hashes tell.
bool FixSpot::somebody_changed_grains() {
  find_hashes();
  if (!model->remembered) return true;
  std::vector<std::int64_t> differences;
  for (std::size_t k = 0; k < model->found.size(); ++k)
    differences.push_back(model->found[k] - (*model->remembered)[k]);
  return model->ranks->sum(differences) != std::vector<std::int64_t>{0, 0, 0};
}

/// Other commands and fixes may have added, taken, moved or renamed grains, or put them into other groups.
void FixSpot::take_changes() {
  check_grains();
  std::vector<spot::Grain> own;
  model->drainage->visit_grains([&own](const spot::Grain &grain) { own.push_back(grain); });
  std::vector<spot::Grain> now;
  const spot::Quantum &quantum = model->drainage->quantum();
  for (int i = 0; i < atom->nlocal; ++i) {
    now.push_back(grain_of_lammps(i));
    now.back().position = model->cell.wrap(snapped(now.back().position, quantum));
  }
  model->drainage->change_grains(find_changes(own, now, *model->ranks));
}

/// Index of a grain in LAMMPS' arrays, which no longer hold it if it was outside the simulation box.
int FixSpot::local_index(std::int64_t grain) const {
  const int index = model->local[static_cast<tagint>(grain)];
  if (index < 0) error->one(FLERR, message("fix spot: ", lost(grain)));
  return index;
}

/// The coordinate of a grain, in the cell, as LAMMPS wants it: an end of the cell, in quanta, may be outside the
/// simulation box by rounding.
double FixSpot::in_box(double coordinate, int axis) const {
  return model->cell.along(axis) ? std::max(coordinate, domain->boxlo[axis]) : coordinate;
}

/// Into the image flags of a grain that came into the cell again this far from where it went (a multiple of the
/// period).
void FixSpot::count_crossings(int i, int axis, double beyond) {
  if (beyond == 0.0) return;
  const int shift = axis == 0 ? 0 : IMGBITS;  // nothing repeats along z
  const imageint mask = IMGMASK, others = atom->image[i] & ~(mask << shift);
  const auto periods = static_cast<imageint>(std::lround(beyond / model->cell.length(axis)));
  atom->image[i] = others | ((((atom->image[i] >> shift) + periods) & mask) << shift);
}

/// Puts a grain of LAMMPS where it is now. After a step its velocity is the displacement over it divided by the
/// timestep.
void FixSpot::move_grain(int i, const double *position, bool after_step) {
  if (was_put_back(atom->tag[i])) {
    // Whatever it was, it is no motion.
    for (int axis = 0; axis < 3; ++axis) {
      atom->x[i][axis] = in_box(position[axis], axis);
      atom->v[i][axis] = 0.0;
    }
    return;
  }
  const double per_time = 1.0 / update->dt;
  for (int axis = 0; axis < 3; ++axis) {
    const double before = model->drainage->quantum().snap(atom->x[i][axis]);
    const double by = model->cell.nearest(position[axis] - before, axis);
    if (after_step) {
      atom->v[i][axis] = by * per_time;
      if (peratom_flag) array_atom[i][axis] += by;
    }
    count_crossings(i, axis, before + by - position[axis]);
    atom->x[i][axis] = in_box(position[axis], axis);
  }
}

/// Positions go back to LAMMPS, and so does who has left. After a step most grains may be at rest: LAMMPS has them
/// where they are.
void FixSpot::write_grains(const std::vector<spot::Grain> &drained, bool after_step) {
  model->local.assign(atom->tag, atom->nlocal);
  if (after_step && atom->nlocal > 0) std::fill_n(atom->v[0], 3 * static_cast<std::size_t>(atom->nlocal), 0.0);
  std::vector<HashSumsOfThread> changes(model->command.threads);
  const auto put = [&](std::int64_t grain, const double *position, std::size_t thread) {
    const int i = model->local[static_cast<tagint>(grain)];
    if (i < 0) throw spot::InvalidPacking(lost(grain));  // LAMMPS' errors are for its own thread
    count_hash(changes[thread].sums, hash_of_lammps(i), -1);
    move_grain(i, position, after_step);
    count_hash(changes[thread].sums, hash_of_lammps(i), 1);
  };
  if (comm->nprocs == 1) {
    model->drainage->visit_grains_at_once(
        [&](const spot::Grain &grain, std::size_t thread) { put(grain.id, grain.position.data(), thread); },
        after_step ? spot::Which::moved : spot::Which::all);
    for (const spot::Grain &grain : drained) model->leaving.push_back(static_cast<tagint>(grain.id));
  } else {
    for (const Delivery &delivery : deliver_grains(drained, after_step))
      if (delivery.left)
        model->leaving.push_back(static_cast<tagint>(delivery.id));
      else
        put(delivery.id, delivery.position, 0);
  }
  for (const HashSumsOfThread &change : changes) add(model->found, change.sums);
}

/// What other ranks' packings tell of grains that LAMMPS has here.
std::vector<Delivery> FixSpot::deliver_grains(const std::vector<spot::Grain> &drained, bool after_step) const {
  std::vector<Delivery> deliveries;
  const auto add = [&](const spot::Grain &grain, bool left) {
    const spot::Vector3 &at = grain.position;
    deliveries.push_back({grain.id, {at.x(), at.y(), at.z()}, left});
  };
  model->drainage->visit_grains([&](const spot::Grain &grain) { add(grain, false); },
                                after_step ? spot::Which::moved : spot::Which::all);
  for (const spot::Grain &grain : drained) add(grain, true);
  return deliver(deliveries, {atom->tag, atom->tag + atom->nlocal}, *model->ranks);
}

/* ----------------------------------------------------------------------
   one step: a whole number of windows
------------------------------------------------------------------------- */

void FixSpot::initial_integrate(int) {
  spot::Drainage &drainage = *model->drainage;
  try {
    if (somebody_changed_grains()) take_changes();
    follow_variables();
    // The clock is a multiple of the window: how many of them make a step changes nothing.
    model->windows += model->windows_per_step;
    drainage.advance_to(static_cast<double>(model->windows) * model->window);
    drainage.require_inside(spot::Which::moved);
    const std::vector<spot::Grain> drained = drainage.take_drained();
    count_at_outlets(drained);
    if (model->recirculation) {
      put_back(drained);
      write_grains({}, true);
    } else {
      write_grains(drained, true);
    }
    if (peratom_flag) add_moves_received();
    remember_grains();
  } catch (const spot::Error &e) {
    fail(e);
  }
  for (const tagint grain : model->leaving) model->drained_mass += atom->rmass[local_index(grain)];
  tell_all_who_leaves();
  const std::size_t left = model->leaving.size() + model->put_back.size();
  if (left > 0) next_reneighbor = update->ntimestep;

  auto &drained = model->drained;
  drained.push_back({model->windows, drained.back().grains + static_cast<std::int64_t>(left)});
  if (drained.size() > static_cast<std::size_t>(model->command.average) + 1) drained.pop_front();
}

/// Grains that have drained come in again and stay those of LAMMPS. All ranks get to know them and where they are now.
void FixSpot::put_back(const std::vector<spot::Grain> &drained) {
  model->put_back.clear();
  model->recirculation->put_back(*model->drainage, drained, model->windows, *model->ranks);
  for (const spot::Grain &grain : drained) model->leaving.push_back(static_cast<tagint>(grain.id));
  tell_all_who_leaves();
  if (model->leaving.empty()) return;
  std::sort(model->leaving.begin(), model->leaving.end());
  std::vector<Delivery> own;
  model->drainage->visit_grains([&](const spot::Grain &grain) {
    const spot::Vector3 &at = grain.position;
    if (std::binary_search(model->leaving.begin(), model->leaving.end(), static_cast<tagint>(grain.id)))
      own.push_back({grain.id, {in_box(at.x(), 0), in_box(at.y(), 1), at.z()}, false});
  });
  model->leaving.clear();
  spot::Bytes bytes;
  spot::append(bytes, own);
  for (const spot::Bytes &of_one : model->ranks->share_with_all(bytes))
    for (const Delivery &grain : spot::ByteReader(of_one).take_all<Delivery>()) model->put_back.push_back(grain);
  std::sort(model->put_back.begin(), model->put_back.end(),
            [](const Delivery &a, const Delivery &b) { return a.id < b.id; });
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!was_put_back(atom->tag[i])) continue;
    model->drained_mass += atom->rmass[i];
    if (peratom_flag) array_atom[i][PASSAGES] += 1.0;
  }
}

bool FixSpot::was_put_back(std::int64_t grain) const {
  const auto found = std::lower_bound(model->put_back.begin(), model->put_back.end(), grain,
                                      [](const Delivery &a, std::int64_t wanted) { return a.id < wanted; });
  return found != model->put_back.end() && found->id == grain;
}

/// Each through the outlet that was nearest when it left.
void FixSpot::count_at_outlets(const std::vector<spot::Grain> &drained) {
  for (const spot::Grain &grain : drained) ++model->drained_at[model->container->nearest_outlet_index(grain.position)];
}

/// Another fix may hand grains to other ranks before LAMMPS asks for those that leave.
void FixSpot::tell_all_who_leaves() {
  if (comm->nprocs == 1) return;
  spot::Bytes own;
  spot::append(own, model->leaving);
  model->leaving.clear();
  for (const spot::Bytes &bytes : model->ranks->share_with_all(own))
    for (const tagint grain : spot::ByteReader(bytes).take_all<tagint>()) model->leaving.push_back(grain);
}

/// LAMMPS drops atoms that are outside a fixed boundary when it hands atoms to their ranks, right after this. Another
/// fix may have taken some of them already. Grains that came in again may be far from home.
void FixSpot::pre_exchange() {
  if (comm->nprocs > 1 && !model->put_back.empty()) bring_home(model->put_back, *atom, *comm, *domain, *model->ranks);
  model->put_back.clear();
  if (model->leaving.empty()) return;
  model->local.assign(atom->tag, atom->nlocal);
  std::int64_t found = 0;
  for (const tagint grain : model->leaving)
    if (const int i = model->local[grain]; i >= 0) {
      atom->x[i][2] = domain->boxlo[2] - model->sizes.largest;
      ++found;
    }
  atom->natoms -= static_cast<bigint>(model->ranks->sum(found));
  model->leaving.clear();
}

void FixSpot::end_of_step() {
  // fix balance has rounded positions when it looked at them in units of the box, and new grains come with any.
  model->drainage->share_out(atom->nlocal, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (int axis = 0; axis < 3; ++axis)
        atom->x[i][axis] = in_box(model->drainage->quantum().snap(atom->x[i][axis]), axis);
  });
  list_spots();
}

void FixSpot::list_spots() {
  const std::vector<spot::Spot> spots = model->drainage->spots();
  model->spots.resize(spots.size() * COLUMNS);
  model->rows.resize(spots.size());
  for (std::size_t k = 0; k < spots.size(); ++k) {
    double *row = model->spots.data() + k * COLUMNS;
    row[ID] = static_cast<double>(spots[k].id);
    row[X] = spots[k].position.x();
    row[Y] = spots[k].position.y();
    row[Z] = spots[k].position.z();
    row[STEPS] = static_cast<double>(spots[k].steps);
    row[VOLUME] = spots[k].volume;
    model->rows[k] = row;
  }
  std::sort(model->rows.begin(), model->rows.end(), [](const double *a, const double *b) { return a[ID] < b[ID]; });
  size_local_rows = static_cast<int>(spots.size());
  array_local = model->rows.data();
}

/* ----------------------------------------------------------------------
   output
------------------------------------------------------------------------- */

/// Between runs a region may be deleted, and finding the overlap may need the walls: find it while they are there.
void FixSpot::post_run() {
  if (!model->drainage) return;
  model->overlap_after_run = largest_overlap();
  warn_of_held_spots();
}

/// Of spots that have climbed less than half of what their steps would take them, though they had time to: walls hold
/// them, and where nothing leads around, the bed above never drains.
void FixSpot::warn_of_held_spots() const {
  constexpr double first_steps = 20.0, many = 0.3;  // steps that say nothing yet; the share of all live spots
  const spot::SpotParameters &parameters = model->command.spots;
  const double birth = model->container->outlets().height() - parameters.radius;
  const std::vector<spot::Spot> spots = model->drainage->spots();
  const auto is_held = [&](const spot::Spot &spot) {
    const double way = parameters.step_height * (static_cast<double>(spot.steps) - first_steps);
    return way > 2.0 * (spot.position.z() - birth);
  };
  const std::int64_t live = model->ranks->sum(static_cast<std::int64_t>(spots.size()));
  const std::int64_t held = model->ranks->sum(std::count_if(spots.begin(), spots.end(), is_held));
  if (static_cast<double>(held) <= many * static_cast<double>(live) || comm->me != 0) return;
  error->warning(FLERR, message("fix spot: walls hold ", held, " of ", live,
                                " spots, which have climbed less than half of the way of their steps: "
                                "is there a roof over an outlet, or no way from it to the bed?"));
}

/// Collective.
double FixSpot::compute_vector(int which) {
  if (!model->drainage) return 0.0;
  switch (which) {
    case 0:
      return static_cast<double>(model->ranks->sum(static_cast<std::int64_t>(model->drainage->spots().size())));
    case 1:
      return static_cast<double>(model->drainage->total().moves);
    case 2:
      return static_cast<double>(model->drainage->total().drained);
    case 3: {
      double mass = 0.0;
      MPI_Allreduce(&model->drained_mass, &mass, 1, MPI_DOUBLE, MPI_SUM, world);
      return mass;
    }
    case 4:
      return mean_outflow();
    case 5:
      return update->whichflag ? largest_overlap() : model->overlap_after_run;
    case 6:
      return static_cast<double>(model->drainage->total().sweeps);
    case 7:
      return model->volume_left();
    default:
      return static_cast<double>(
          model->ranks->sum(model->drained_at.at(static_cast<std::size_t>(which - FIRST_OF_OUTLETS))));
  }
}

/// In distance units: its share of the mean of the two diameters, times that of the largest grains.
double FixSpot::largest_overlap() const {
  const double depth = -model->ranks->least(std::vector<double>{-model->drainage->largest_overlap().depth})[0];
  return depth * model->sizes.largest;
}

/// Grains a time, over the last `average` steps (fewer when no more were done).
double FixSpot::mean_outflow() const {
  const Model::Drained &first = model->drained.front(), &last = model->drained.back();
  if (last.windows == first.windows) return 0.0;
  return static_cast<double>(last.grains - first.grains) /
         (static_cast<double>(last.windows - first.windows) * model->window);
}

/* ----------------------------------------------------------------------
   restart files
------------------------------------------------------------------------- */

void FixSpot::write_restart(FILE *file) {
  SavedRun run;
  MPI_Allreduce(&model->drained_mass, &run.drained_mass, 1, MPI_DOUBLE, MPI_SUM, world);
  run.drained_at = model->ranks->sum(model->drained_at);
  run.sizes = model->sizes;
  run.windows = model->windows;
  for (const Model::Drained &drained : model->drained) {
    run.windows_after_step.push_back(drained.windows);
    run.drained_after_step.push_back(drained.grains);
  }
  try {
    if (!model->drainage)
      throw spot::InvalidState("there is nothing to write into a restart file before the first run");
    run.settings = model->command.settings();
    run.window = model->command.window.value_or(0.0);
    write_run(run, model->drainage->save(), file, *model->ranks);
  } catch (const spot::Error &e) {
    fail(e);
  }
}

void FixSpot::restart(char *bytes) {
  try {
    model->saved = read_run(bytes);
  } catch (const spot::Error &e) {
    fail(e);
  }
  model->sizes = model->saved->sizes;
  model->windows = model->saved->windows;
  // Other ranks' shares are in that of rank 0. A number of outlets that is another one is refused later.
  model->drained_mass = comm->me == 0 ? model->saved->drained_mass : 0.0;
  model->drained_at.assign(model->drained_at.size(), 0);
  if (comm->me == 0 && model->saved->drained_at.size() == model->drained_at.size())
    model->drained_at = model->saved->drained_at;
  model->drained.clear();
  for (std::size_t k = 0; k < model->saved->drained_after_step.size(); ++k)
    model->drained.push_back({model->saved->windows_after_step[k], model->saved->drained_after_step[k]});
}

/// The clock goes on in the windows in which it has counted. None has been chosen if there was no step.
void FixSpot::go_on_with_saved_window() {
  const double saved = model->saved->window;
  if (saved == 0.0) return;
  const double now = model->command.window.value_or(saved);
  if (now != saved)
    throw spot::InvalidState(message("window was ", saved, " in the run that the restart file is of, but is ", now,
                                     " now: leave it out; to start anew, give the fix another ID"));
  model->command.window = saved;
}

/* ----------------------------------------------------------------------
   output per atom: what has become of each grain since the fix was made
------------------------------------------------------------------------- */

void FixSpot::offer_output_per_atom() {
  peratom_flag = 1;
  size_peratom_cols = GRAIN_COLUMNS;
  peratom_freq = 1;
  restart_peratom = 1;
  create_attribute = 1;
  grow_arrays(atom->nmax);
  for (int i = 0; i < atom->nlocal; ++i) set_arrays(i);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
}

/// A grain may have been moved on several ranks in one step.
void FixSpot::add_moves_received() {
  const spot::MovesReceived received = model->drainage->take_moves_received();
  std::vector<DeliveredMoves> deliveries;
  for (const auto &[grain, moves] : received) deliveries.push_back({grain, moves});
  if (comm->nprocs > 1) deliveries = deliver(deliveries, {atom->tag, atom->tag + atom->nlocal}, *model->ranks);
  for (const DeliveredMoves &delivery : deliveries)
    array_atom[local_index(delivery.id)][MOVES] += static_cast<double>(delivery.moves);
}

void FixSpot::grow_arrays(int atoms) { memory->grow(array_atom, atoms, GRAIN_COLUMNS, "fix_spot:array_atom"); }

void FixSpot::copy_arrays(int from, int to, int) { std::copy_n(array_atom[from], +GRAIN_COLUMNS, array_atom[to]); }

void FixSpot::set_arrays(int i) { std::fill_n(array_atom[i], +GRAIN_COLUMNS, 0.0); }

int FixSpot::pack_exchange(int i, double *buffer) {
  std::copy_n(array_atom[i], +GRAIN_COLUMNS, buffer);
  return GRAIN_COLUMNS;
}

int FixSpot::unpack_exchange(int i, double *buffer) {
  std::copy_n(buffer, +GRAIN_COLUMNS, array_atom[i]);
  return GRAIN_COLUMNS;
}

/// In a restart file the values of each fix come after their number, which counts itself.
int FixSpot::pack_restart(int i, double *buffer) {
  buffer[0] = GRAIN_RECORD;
  pack_exchange(i, buffer + 1);
  buffer[GRAIN_RECORD - 1] = checksum_of(atom->tag[i], array_atom[i]);
  return GRAIN_RECORD;
}

void FixSpot::unpack_restart(int i, int nth) {
  if (!peratom_flag) return;
  // The records of other fixes come before; lengths that are damaged lead anywhere.
  double *values = atom->extra[i], at = 0.0;
  const double last = atom->nextra_store - GRAIN_RECORD;
  for (; nth > 0 && at >= 0.0 && at <= last; --nth) at += std::trunc(values[static_cast<int>(at)]);
  if (at >= 0.0 && at <= last) {
    values += static_cast<int>(at);
    unpack_exchange(i, values + 1);
    if (values[0] == GRAIN_RECORD && values[GRAIN_RECORD - 1] == checksum_of(atom->tag[i], array_atom[i])) return;
  }
  error->one(FLERR, message("fix spot: the restart file is damaged: what it has of grain ", atom->tag[i]));
}

int FixSpot::size_restart(int) { return GRAIN_RECORD; }

int FixSpot::maxsize_restart() { return GRAIN_RECORD; }

double FixSpot::memory_usage() {
  const Model &m = *model;
  std::size_t bytes = m.local.memory() + spot::bytes_in(m.leaving, m.put_back, m.spots, m.rows);
  bytes += m.drained.size() * sizeof m.drained[0];
  if (m.drainage) bytes += m.drainage->memory();
  if (peratom_flag) bytes += atom->nmax * (GRAIN_COLUMNS * sizeof(double) + sizeof(double *));
  return static_cast<double>(bytes);
}
