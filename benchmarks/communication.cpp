// SPDX-License-Identifier: GPL-2.0-or-later
// What ranks tell each other in a window of steady drainage, and what each of them has to do: the silo of examples/silo
// drains on one rank until the flow is steady, and goes on from there for a while on every number of ranks asked for.
// Ranks are threads of this program, so that there may be more of them than processors; what they send is counted, and
// takes no time. See README.md.
//
//   benchmark-communication PACKING WARM_UP MEASURE RANKS...
//
// PACKING: data file of LAMMPS; times in tau. Prints a table with one row a rank.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "ranks_of_threads.hpp"
#include "read_grains.hpp"
#include "spot/drivers/defaults.hpp"
#include "spot/drivers/glass_beads.hpp"
#include "spot/drivers/windowed_drainage.hpp"
#include "spot/geometry/silos.hpp"
#include "spot/walk/spot_walk.hpp"

namespace {

using spot::Bytes;
using spot::WindowedDrainage;

constexpr double window = 0.1;

/// Twice the time after which ranks look whether to share layers out anew.
constexpr double time_to_balance = 2.0 * 16.0 * window;

/// What WindowedDrainage sends, in the order in which a window begins with it.
enum Kind { moves, shares, weights, balancing, migrants, border, reductions, kinds };
constexpr const char* names[kinds] = {"moves", "shares", "weights", "balancing", "migrants", "border", "reductions"};

/// Of this thread (s).
double processor_time() {
  std::timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Traffic {
  std::int64_t calls = 0, messages = 0, bytes = 0;
};

/// Hands everything on to another communicator and counts it. In a window the first exchange is of moves and spots,
/// then come those of shares and weights, and, where layers are shared out anew, of all that is in them; every exchange
/// of migrants is followed by one of borders.
class Counting : public spot::Communicator {
 public:
  using spot::Communicator::sum;
  explicit Counting(std::shared_ptr<Communicator> other) : other_(std::move(other)) {}

  int rank() const override { return other_->rank(); }
  int size() const override { return other_->size(); }
  const Traffic& of(int kind) const { return traffic_[static_cast<std::size_t>(kind)]; }
  /// Processor time of talking, of which threads have another than processes (s).
  double talk() const { return talk_; }
  void begin() {
    traffic_ = {};
    talk_ = 0.0;
  }
  void begin_window() { exchanges_ = neighbour_exchanges_ = 0; }

  std::vector<Bytes> exchange(std::vector<Bytes> outgoing) override {
    Traffic& kind = called(static_cast<Kind>(exchanges_++));
    for (std::size_t to = 0; to < outgoing.size(); ++to)
      if (static_cast<int>(to) != rank()) add(kind, outgoing[to]);
    return timed([&] { return other_->exchange(std::move(outgoing)); });
  }

  std::array<Bytes, 2> exchange_with_neighbours(std::array<Bytes, 2> outgoing) override {
    Traffic& kind = called(exchanges_ > balancing ? balancing : neighbour_exchanges_++ % 2 == 0 ? migrants : border);
    for (const Bytes& bytes : outgoing) add(kind, bytes);
    return timed([&] { return other_->exchange_with_neighbours(std::move(outgoing)); });
  }

  std::vector<std::int64_t> sum(std::vector<std::int64_t> values) override {
    called(reductions).bytes += static_cast<std::int64_t>(8 * values.size());
    return timed([&] { return other_->sum(std::move(values)); });
  }
  std::vector<double> least(std::vector<double> values) override {
    called(reductions).bytes += static_cast<std::int64_t>(8 * values.size());
    return timed([&] { return other_->least(std::move(values)); });
  }
  Pair first(Pair pair) override {
    called(reductions).bytes += sizeof pair;
    return timed([&] { return other_->first(pair); });
  }

 private:
  template <typename Call>
  std::invoke_result_t<Call> timed(const Call& call) {
    const double start = processor_time();
    auto answer = call();
    talk_ += processor_time() - start;
    return answer;
  }
  Traffic& called(Kind kind) {
    ++traffic_[kind].calls;
    return traffic_[kind];
  }
  static void add(Traffic& kind, const Bytes& bytes) {
    kind.messages += bytes.empty() ? 0 : 1;
    kind.bytes += static_cast<std::int64_t>(bytes.size());
  }

  std::shared_ptr<Communicator> other_;
  std::array<Traffic, kinds> traffic_;
  int exchanges_ = 0, neighbour_exchanges_ = 0;
  double talk_ = 0.0;
};

// ---- the drainage, as examples/silo/in.silo_spot has it

spot::SpotParameters spot_parameters() {
  spot::SpotParameters spots = spot::glass_beads::spots(1.0, 1.0);
  spots.injection_rate = spot::births_for(69.6, spots, 1.0);
  spots.holds_outflow = true;
  return spots;
}

std::shared_ptr<const spot::Container> silo() {
  return spot::box_silo(-25.0, 25.0, -4.0, 4.0, spot::Orifice{{0.0, 0.0, 0.0}, 4.0}, {0.25, 2.0});
}

template <typename Start>
WindowedDrainage drainage(const Start& start, const std::shared_ptr<spot::Communicator>& ranks) {
  return {spot_parameters(),
          spot::glass_beads::relaxation(),
          spot::DrainageLimits{0.0},
          window,
          1,
          silo(),
          1.0,
          200.0,
          start,
          ranks};
}

/// Of drawing one birth (s), which every rank does for all births.
double birth_time() {
  constexpr int births = 100000;
  const auto container = silo();
  const spot::SpotParameters spots = spot_parameters();
  const spot::SpotWalk walk(spots, *container);
  const double start = processor_time();
  double time = 0.0, height = 0.0;
  for (int birth = 0; birth < births; ++birth) {
    height += walk.birth(birth, time, *container).position.z();
    time = spots.injection_rate.next_birth(time, walk.births_expected(birth));
  }
  return height < 0.0 ? (processor_time() - start) / births : 0.0;
}

/// What one rank has to say at the end.
struct Report {
  std::array<Traffic, kinds> traffic;
  double processor;  // s, without talking
  std::size_t memory;
  std::int64_t grains, spots, volume_moved, moves, sweeps;
};

/// Of the windows from `from` to `to`. Before them ranks have shared the layers out.
Report measure(const std::vector<Bytes>& saved, double from, double to, std::shared_ptr<spot::Communicator> ranks) {
  const auto counting = std::make_shared<Counting>(std::move(ranks));
  WindowedDrainage draining = drainage(saved, counting);
  const auto advance = [&](double first, double last) {
    for (int k = 1; k <= std::lround((last - first) / window); ++k) {
      counting->begin_window();
      draining.advance_to(first + k * window);
    }
  };
  advance(from - time_to_balance, from);
  const spot::Counters before = draining.counters();
  counting->begin();
  const double start = processor_time();
  advance(from, to);
  Report report = {};
  report.processor = processor_time() - start - counting->talk();
  for (int kind = 0; kind < kinds; ++kind) report.traffic[static_cast<std::size_t>(kind)] = counting->of(kind);
  report.memory = draining.memory();
  draining.visit_grains([&](const spot::Grain&) { ++report.grains; });
  report.spots = static_cast<std::int64_t>(draining.spots().size());
  report.volume_moved = draining.counters().volume_moved - before.volume_moved;
  report.moves = draining.counters().moves - before.moves;
  report.sweeps = draining.counters().sweeps - before.sweeps;
  return report;
}

void print(const std::vector<Report>& reports, double windows) {
  for (std::size_t rank = 0; rank < reports.size(); ++rank) {
    const Report& one = reports[rank];
    std::printf("%zu,%zu,%.0f,%lld,%lld,%zu,%.6g,%.6g,%.6g,%.6g", reports.size(), rank, windows,
                static_cast<long long>(one.grains), static_cast<long long>(one.spots), one.memory,
                1e3 * one.processor / windows, static_cast<double>(one.moves) / windows,
                static_cast<double>(one.volume_moved) / spot::grain_volume / windows,
                static_cast<double>(one.sweeps) / windows);
    for (const Traffic& kind : one.traffic)
      std::printf(",%.6g,%.6g,%.6g", static_cast<double>(kind.calls) / windows,
                  static_cast<double>(kind.messages) / windows, static_cast<double>(kind.bytes) / windows);
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 5) throw std::runtime_error("wants PACKING WARM_UP MEASURE RANKS...");
  const double from = std::atof(argv[2]), to = from + std::atof(argv[3]);
  std::vector<Bytes> saved;
  {
    WindowedDrainage draining = drainage(read_grains(argv[1]), std::make_shared<spot::Alone>());
    draining.advance_to(from - time_to_balance);
    saved.push_back(draining.save());
  }
  std::printf("birth_us %.4g\n", 1e6 * birth_time());
  std::printf("ranks,rank,windows,grains,spots,memory,processor_ms,moves_made,grains_moved,sweeps");
  for (const char* name : names) std::printf(",%s_calls,%s_messages,%s_bytes", name, name, name);
  std::printf("\n");
  for (int k = 4; k < argc; ++k) {
    std::vector<Report> reports(static_cast<std::size_t>(std::atoi(argv[k])));
    scenes::on_ranks(static_cast<int>(reports.size()), [&](std::shared_ptr<spot::Communicator> ranks) {
      const auto rank = static_cast<std::size_t>(ranks->rank());
      reports[rank] = measure(saved, from, to, std::move(ranks));
    });
    print(reports, std::round((to - from) / window));
    std::fflush(stdout);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "benchmark-communication: %s\n", error.what());
  return 1;
}
