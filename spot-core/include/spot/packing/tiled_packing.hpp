// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <unordered_set>
#include <utility>
#include <vector>

#include "spot/base/aligned_vector.hpp"
#include "spot/base/bytes.hpp"
#include "spot/base/quantum.hpp"
#include "spot/geometry/container.hpp"
#include "spot/packing/displacement.hpp"
#include "spot/packing/packing.hpp"
#include "spot/packing/point.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/parallel/slabs.hpp"
#include "spot/parallel/workers.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

namespace kernels {
struct Kernels;
}

/// Equal spheres laid out for vector kernels, threads and ranks.
///
/// Positions are whole numbers of quanta of 2^-24 d, in 32 bits, from the lowest corner of the grid; they wrap around,
/// and the cell that a grain is listed in tells where it is. Integer sums are exact, so neither cells, lists, threads
/// nor instruction sets can change a bit of the result.
///
/// Layout: the cells of a grid, x fastest, have `capacity` slots each; a row of cells is one contiguous range of slots,
/// so that kernels run over whole ranges and need no list of who is there. As in Packing, cells and neighbour lists are
/// functions of the *references*, the places where grains were listed last; a grain half a skin away from its reference
/// is listed anew. Nobody looks for such grains before the moves and pushes in a cell, laid end to end, could have
/// brought one there. Lists have `list_capacity` places a slot.
///
/// Every cell keeps an account: how many moves have reached into it, less those that sweeps have paid for.
///
/// Ranks own slabs of the grid's layers, and the grains listed there; of the layers next to theirs, the *border*, they
/// hold copies. What a cell does depends on itself and its neighbours only, so neither does the number of ranks change
/// a bit. Functions that say so are collective.
class TiledPacking {
 public:
  /// Collective. Grains, of which each rank brings some, may go down to `outlet`. Throws InvalidPacking as Packing
  /// does, and InvalidParameter if the environment variable SPOT_INSTRUCTION_SET names kernels that cannot run here.
  TiledPacking(double diameter, double extent, double outlet, const std::vector<Grain>& grains,
               const Container& container, std::shared_ptr<Communicator> communicator = std::make_shared<Alone>());

  /// Collective. A packing that goes on from a saved state, of which each rank brings all: the parts that save() gave
  /// on every rank, of however many. Throws InvalidState if a part is damaged or missing.
  TiledPacking(double diameter, double extent, const std::vector<Bytes>& saved, const Container& container,
               std::shared_ptr<Communicator> communicator = std::make_shared<Alone>());

  /// Throws InvalidParameter unless spots of this radius are small enough, below 8 diameters.
  static void require_radius(double radius, double diameter);

  double diameter() const { return diameter_; }
  double extent() const { return extent_; }
  const Quantum& quantum() const { return quantum_; }

  /// Grains of this rank.
  std::size_t size() const { return size_; }

  /// The rank that owns the layer at this height.
  int owner(double height) const { return slabs_.owner(layer(height)); }

  /// The ranks, from first to last, that hold grains a move with its middle at this height may reach.
  std::pair<int, int> reached(double height, double radius) const;

  /// What is needed to go on from here, apart from walls: the part of this rank.
  Bytes save() const;

  /// Collective. Shares the layers out anew, by what was done in each of them since that was done last, if that makes
  /// the part of the busiest rank smaller by more than it costs. Returns whether it has.
  bool balance(const Container& container);

  /// Calls visit(grain) for all grains of this rank, in no particular order.
  void visit_grains(const std::function<void(const Grain&)>& visit) const;

  /// Gives moves their weights, when it is told the shares of this rank's grains in each of them.
  using Weigh = std::function<void(const std::vector<int>& shares, std::vector<Move>& moves)>;

  /// Collective. Applies the moves, one after the other to every grain, as displace() does. They are weighed before the
  /// first one is applied. Each cell that a move may have reached is charged one move. Lists are up to date afterwards.
  /// `moves`: those that may reach grains of this rank, in the order of (spot, number) if there are several ranks.
  /// `received`, if there is one: counts the moves of each grain. Throws InvalidParameter unless the radius is below 8
  /// diameters.
  void displace(std::vector<Move>& moves, const SpotParameters& spots, const Weigh& weigh, const Container& container,
                Workers& workers, MovesReceived* received = nullptr);

  /// Collective. One sweep over the cells that are due, those charged with `due` moves or more, which pays for `due` of
  /// them; grains of other cells stay where they are, and those due go all the way themselves. A cell in which a grain
  /// was overlapped by more than `deepest` diameters stays due. Returns the number of grains swept on all ranks, 0 when
  /// no cell was due. Lists are up to date afterwards.
  std::size_t sweep(const RelaxationParameters& parameters, double due, double deepest, const Container& container,
                    Workers& workers);

  /// The largest overlap, in diameters, of the grains in the last sweep, before it pushed them apart.
  double overlap_swept() const { return overlap_swept_; }

  /// Marks the grains near walls anew, as after the walls changed.
  void mark_near_walls(const Container& container);

  /// Collective. Takes out the grains with these ids, which are this rank's, and brings in others, of which each rank
  /// brings some; a grain that has moved is one that goes and one that comes. Those that come fall, as settle() finds
  /// them. All others keep their momenta, and cells their accounts. Throws InvalidPacking, and is of no use any more,
  /// if a grain is not there, is there already, or is beyond the extent.
  void change(const std::vector<std::int64_t>& gone, const std::vector<Grain>& come, const Container& container);

  /// The largest overlap of a grain of this rank that came in the last change() with any other, as it came.
  const Overlap& largest_overlap_of_new() const { return largest_overlap_of_new_; }

  /// Collective. Moves grains down that nothing holds: those that came, those above who went, or `everybody` that
  /// hangs; in sweeps, until contacts hold them; others stay where they are. `in_contact`: overlap of grains that bear
  /// on each other, in diameters. Returns how many grains of all ranks came down.
  std::size_t settle(bool everybody, std::uint64_t seed, double in_contact, const Container& container,
                     Workers& workers);

  /// Takes out this rank's grains with centres below the outlet and adds them to `drained`.
  void take_out_below(double outlet, std::vector<Grain>& drained);

  /// Of a grain of this rank and any other.
  Overlap largest_overlap() const;

  /// Bytes on this rank.
  std::size_t memory() const;

 private:
  struct Row {
    std::uint32_t first, last;  // cells
  };
  struct Cell {
    int x, y, z;
  };

  /// What one worker does of a window's moves: what they do in some of this rank's layers.
  struct Part {
    int first_layer, last_layer;
    std::vector<Row> rows;                 // of cells that moves may reach, move by move
    std::vector<std::size_t> end_of_rows;  // in `rows`, of each move
    std::vector<int> shares;               // of the grains here in each move
    std::size_t lengthened;                // the end of the moves whose lengths are in paths
    bool look;                             // did a path become too long?

    std::size_t first_row(std::size_t move) const { return move == 0 ? 0 : end_of_rows[move - 1]; }
    template <typename Visit>
    void visit_cells(std::size_t move, const Visit& visit) const {
      for (std::size_t r = first_row(move); r < end_of_rows[move]; ++r)
        for (std::uint32_t cell = rows[r].first; cell < rows[r].last; ++cell) visit(cell);
    }
  };

  /// What one worker has to do in a sweep.
  struct Task {
    std::uint32_t first, last;          // of due_cells_
    std::uint32_t grains;               // in them
    std::vector<std::uint32_t> active;  // their slots, cell by cell, and kernels::ahead more
    std::vector<std::uint8_t> in_cell;  // how many of them are in each cell
    std::vector<std::uint32_t> walled;  // places in `active` of those near walls
    std::vector<Point> pushes;
    std::vector<Corrections> corrections;  // of each cell
    float depth;                           // of the deepest overlap, as in a push
  };

  /// The neighbours that one worker has found, of one grain after the other.
  struct Finding {
    std::vector<std::uint32_t> found;
    std::vector<std::size_t> ends;  // in `found`, of each grain
    std::vector<Row> rows;

    void clear() {
      found.clear();
      ends.clear();
    }
  };

  struct TouchingPlane {
    std::int32_t Point::*axis;
    std::int32_t at;  // where grains that touch it have their centres, in wrapped quanta from low
    bool grains_below;
  };

  /// A place in the layers that this rank holds.
  struct Place {
    std::uint32_t cell, in_cell;
  };

  struct SavedGrain;
  struct SavedCell;

  /// One sweep of grains that come down.
  struct Settling {
    std::uint64_t seed;
    int sweep;
    double in_contact;
    bool last;
  };

  TiledPacking(double diameter, double extent, std::shared_ptr<Communicator> communicator);

  // Places. "From low": in deck units, from the lowest corner of the grid.
  std::array<std::int64_t, 3> quanta(const Vector3& from_low) const;
  Point wrapped(const Vector3& from_low) const;
  Vector3 from_low(const Point& point, const Cell& listed_in) const;
  Vector3 from_low(const Point& point, std::uint32_t index) const { return from_low(point, cell(index)); }
  Vector3 position(std::uint32_t slot) const { return low_ + from_low(points_[slot], slot / capacity_); }
  Grain grain(std::uint32_t slot) const;
  int cell_coordinate(double from_low, int axis) const;
  int layer(double height) const { return cell_coordinate(height - low_.z(), 2); }
  std::uint32_t cell_at(const Vector3& from_low) const;
  Cell cell(std::uint32_t index) const;
  void find_rows(const Vector3& from_low, double reach, int first, int last, std::vector<Row>& rows) const;
  std::uint32_t cells() const { return static_cast<std::uint32_t>(account_.size()); }
  std::uint32_t cells_in_layer() const { return static_cast<std::uint32_t>(n_[0] * n_[1]); }

  // What of it this rank owns.
  int rank_layers() const { return slabs_.first(communicator_->rank() + 1) - slabs_.first(communicator_->rank()); }
  std::uint32_t first_owned() const { return static_cast<std::uint32_t>(border_[0]) * cells_in_layer(); }
  std::uint32_t last_owned() const {
    return first_owned() + static_cast<std::uint32_t>(rank_layers()) * cells_in_layer();
  }
  std::uint32_t first_cell_of(int layer) const {
    return static_cast<std::uint32_t>(layer - first_layer_) * cells_in_layer();
  }
  bool owned(std::uint32_t cell) const { return cell >= first_owned() && cell < last_owned(); }

  void set_edges();
  void set_grid(const Vector3& low, const Vector3& high);
  void set_slabs(const Slabs& slabs);
  std::vector<Grain> take_own(const std::vector<Grain>& grains) const;
  Place ensure_room(std::uint32_t cell);
  std::uint32_t slot(const Place& place) const { return place.cell * capacity_ + place.in_cell; }
  bool occupied(std::uint32_t slot) const { return points_[slot].state != Point::empty; }
  void occupy(std::uint32_t slot, std::int64_t id, const Point& point, const Point& reference);
  void vacate(std::uint32_t slot);
  void set_capacity(std::uint32_t capacity);
  void note_change(std::uint32_t slot);

  // Lists.
  void list_all(const Container& container);
  void update_lists(const Container& container, Workers& workers);
  void find_wandered();
  void move_reference(Place place);
  void list_wandered(const Container& container, Workers& workers);
  void unlist(std::uint32_t slot);
  void rename(std::uint32_t from, std::uint32_t to);
  void list(std::uint32_t slot, const Container& container);
  void list(std::uint32_t slot, const std::uint32_t* found, std::size_t n, const Container& container);
  void find_planes(const Container& container);
  void other_contacts(const Container& container, const Vector3& centre, double reach, WallContacts& contacts) const;
  void find_neighbours(std::uint32_t slot, Finding& finding) const;
  void remove_neighbour(std::uint32_t slot, std::uint32_t neighbour);
  std::uint32_t* list_of(std::uint32_t slot) { return lists_.data() + static_cast<std::size_t>(slot) * list_capacity_; }
  void add_neighbour(std::uint32_t slot, std::uint32_t neighbour);
  void mark_near_wall(std::uint32_t slot, const Container& container);

  // Other ranks.
  void emigrate(std::uint32_t slot, int layer);
  void exchange_migrants(const Container& container);
  void exchange_border(const Container& container);
  Bytes changes(int side);
  void take_changes(const Bytes& bytes, int side, const Container& container);
  void choose_sent(std::int32_t account);
  template <typename Visit>
  void visit_sent(std::uint32_t first_cell, const Visit& visit) const;
  std::uint32_t first_of_border(int side, bool own) const;

  // What goes elsewhere.
  void save_layers(int first, int last, Bytes& bytes) const;
  void take_saved(ByteReader& reader, std::vector<SavedGrain>& grains, std::vector<SavedCell>& cells) const;
  void fill(const std::vector<SavedGrain>& grains, const std::vector<SavedCell>& cells, const Container& container);
  std::vector<std::int64_t> grains_in_layers() const;

  // Others' changes.
  void cover(const std::vector<Grain>& come, const Container& container);
  void grow(const std::array<int, 3>& below, const std::array<int, 3>& above, const Container& container);
  std::vector<std::int64_t> of_all_ranks(const std::vector<std::int64_t>& ids) const;
  void mark_going(const std::unordered_set<std::int64_t>& gone);
  std::vector<Grain> stay_under_other_ids(const std::vector<Grain>& come);
  void take_out_going(const Container& container);
  void require_within_extent(const std::vector<Grain>& come) const;
  void require_new_ids(const std::vector<Grain>& incoming) const;

  // Grains that come down.
  void find_hanging(const Container& container);
  bool is_borne(std::uint32_t at, const Container& container) const;
  bool stands_on_orifice(const Vector3& at, double reach, const Container& container) const;
  bool stands_on_wall(const Vector3& at, const Container& container) const;
  void start_falling(std::uint32_t at);
  void note_neighbours_above(std::uint32_t at);
  void note_above_falling_copies();
  template <typename Visit>
  void visit_copies(const Visit& visit) const;
  void update_falling(const Container& container, Workers& workers);
  void keep(std::vector<Place>& places, std::int32_t first_state, std::int32_t last_state) const;
  void sweep_falling(const Settling& settling, const Container& container);
  std::int32_t next_state(std::uint32_t at, Point& step, const Settling& settling, const Container& container) const;
  double push_off_bearers(std::uint32_t at, const Point& place, double in_contact, const Container& container,
                          Point& push) const;
  void part_from_bearers(std::uint32_t at, Point& step, double in_contact, const Container& container) const;
  bool lies_on_floor(std::uint32_t at, const Container& container) const;
  std::vector<Vector3> normals_of_contacts(std::uint32_t at, std::int32_t least, const Container& container) const;
  void press_together(double in_contact, const Container& container, Workers& workers);
  void take_along_neighbours(const Container& container);
  void set_state(std::uint32_t at, std::int32_t state);
  double depth_in_orifice(const Vector3& at, const Container& container) const;
  double part_laid(double in_contact, double down, const Container& container);
  void move_falling(std::uint32_t at, const Point& by, std::int32_t state);

  // Moves.
  double reach_of_move(double radius) const;
  void set_parts(int workers);
  void find_moves(const std::vector<Move>& moves, const SpotParameters& spots, Workers& workers);
  void find_moves(Part& part, const std::vector<Move>& moves, double radius);
  std::size_t end_before_a_look(const std::vector<Move>& moves, std::size_t first, Workers& workers);
  void lengthen(Part& part, std::size_t first, std::int32_t limit);
  void apply_moves(Part& part, std::size_t first, std::size_t end, bool count);
  void count_received(const Row& row, const Point& middle, std::vector<std::uint32_t>& found);

  // Sweeps.
  void collect(Task& task);
  void set_border(std::int32_t from, std::int32_t to, std::int32_t due);
  void push_apart(Task& task, const RelaxationParameters& parameters, const Container& container) const;
  void find_larger_overlap(std::uint32_t slot, double& least, Overlap& largest) const;
  void part_coincident(Task& task, double push) const;
  void push_off_planes(Task& task, float strength) const;
  void push_off_other_walls(Task& task, double strength, const Container& container) const;
  void push(Point& point, const Vector3& by) const;
  void apply(Task& task, int due, float deepest, float momentum);

  static constexpr std::int32_t every_cell = std::numeric_limits<std::int32_t>::min();
  static constexpr std::int32_t no_cell = std::numeric_limits<std::int32_t>::max();

  /// Accounts are kept in sixteenths of a move, and a sweep can cost such parts.
  static constexpr std::int32_t parts_of_move = 16;

  const kernels::Kernels* kernels_;
  double diameter_, extent_;
  Quantum quantum_;
  double skin_;
  Vector3 low_ = Vector3::Zero();
  std::array<double, 3> edge_, per_edge_;    // of a cell, and 1 over it
  std::array<std::int64_t, 3> edge_quanta_;  // the same
  std::array<int, 3> n_ = {0, 0, 0};         // cells along each axis
  std::uint32_t capacity_ = 8;
  std::uint32_t list_capacity_;
  std::size_t size_ = 0;
  double overlap_swept_ = 0.0;

  std::shared_ptr<Communicator> communicator_;
  Slabs slabs_{std::vector<std::int64_t>{0}, 1};
  std::array<int, 2> border_ = {0, 0};         // layers held of the ranks below and above: 0 or 1
  int first_layer_ = 0;                        // of those held
  std::array<std::vector<Place>, 2> changed_;  // what has come, gone or been listed anew where others hold copies
  std::array<Bytes, 2> migrants_;              // grains that go to the ranks below and above
  std::vector<std::uint8_t> sent_;             // of border cells, ours and theirs: will positions be sent?

  AlignedVector<Point> points_, references_;
  AlignedVector<Point> momenta_;              // the last correction, as far as it is carried on
  std::vector<std::int64_t> ids_;             // -1 in empty slots
  std::vector<TouchingPlane> planes_;         // the container's axis planes, unless there are too many
  std::vector<std::uint8_t> near_wall_;       // a bit for each of these; the highest for all other walls
  std::vector<std::uint8_t> cell_near_wall_;  // has any grain of this cell ever been near one?
  AlignedVector<std::uint32_t> lists_;
  std::vector<std::uint8_t> list_size_;
  std::vector<std::uint8_t> marks_;    // of slots, zero between uses
  std::vector<std::int32_t> account_;  // in parts of a move
  std::vector<std::int32_t> path_;     // of each cell: no grain in it is farther from its reference, in quanta

  std::vector<Place> loosened_;  // of grains that may have lost what bore them
  std::vector<Place> falling_;   // of grains that come down, and perhaps of others
  std::vector<Place> laid_;      // of those that have, and perhaps of others
  Overlap largest_overlap_of_new_;

  std::vector<std::int64_t> work_;  // in each layer of this rank, in cells reached by moves, since balance()

  // Kept between calls to save allocations.
  std::vector<Part> parts_;                  // one for each worker
  std::vector<std::int64_t> cells_reached_;  // by the moves of a window, in each layer of this rank, and 1
  std::vector<Point> middles_, steps_;
  Reach reach_{};
  std::vector<int> shares_;              // of this rank's grains in each move
  std::vector<std::uint32_t> received_;  // moves of the grain in each slot, where they are counted
  std::vector<std::uint32_t> wandered_cells_, due_cells_;
  std::vector<Place> wandered_;
  std::vector<Finding> findings_;
  bool look_ = false;  // must lists be brought up to date before the next move?
  std::vector<Task> tasks_;
};

}  // namespace spot
