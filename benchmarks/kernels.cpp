// SPDX-License-Identifier: GPL-2.0-or-later
// Time of the kernels of spot-core for each instruction set that this processor has, and of the moves and sweeps that
// are made of them, on the packing at rest of examples/silo. Lengths in grain diameters. See README.md.
#include "packing/kernel_builds.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "read_grains.hpp"
#include "spot/geometry/silos.hpp"
#include "spot/packing/tiled_packing.hpp"
#include "spot/relaxation/cell_relaxation.hpp"
#include "spot/walk/spot_walk.hpp"

namespace {

using spot::Point;
using spot::Vector3;
using spot::kernels::Kernels;

constexpr double quanta = 16777216.0;  // in a diameter, as TiledPacking has them
constexpr double radius = 3.53, influence = 2.5e-3, step_height = 0.8, diffusion_length = 1.25;

const std::vector<spot::Grain>& grains() {
  static const std::vector<spot::Grain> all = read_grains(SPOT_BENCHMARK_PACKING);
  return all;
}

// ---- kernels, on an array laid out as TiledPacking does it

/// Cells of 1.5 d with eight slots each, x fastest, and lists of the neighbours within 1.5 d.
struct Tiles {
  static constexpr std::uint32_t slots = 8, list_capacity = spot::kernels::lanes;
  static constexpr double edge = 1.5, reach = 1.5;

  std::array<int, 3> cells = {};
  Vector3 low;
  spot::AlignedVector<Point> points;
  std::vector<std::uint32_t> grains;  // slots of them
  spot::AlignedVector<std::uint32_t> lists;
  std::vector<std::uint32_t> blocks;
  std::vector<std::uint8_t> list_size;

  Tiles() {
    low = Vector3(-25, -4, -1);
    cells = {34, 6, 90};
    points.assign(static_cast<std::size_t>(cells[0] * cells[1] * cells[2]) * slots, Point{0, 0, 0, Point::empty});
    lists.assign(points.size() * list_capacity, 0);
    list_size.assign(points.size(), 0);
    blocks.resize(points.size());
    std::iota(blocks.begin(), blocks.end(), 0u);
    for (const spot::Grain& grain : ::grains()) {
      const std::uint32_t first = cell(grain.position) * slots;
      for (std::uint32_t slot = first; slot < first + slots; ++slot)
        if (points[slot].state == Point::empty) {
          points[slot] = point(grain.position);
          break;
        }
    }
    for (std::uint32_t slot = 0; slot < points.size(); ++slot)
      if (points[slot].state == Point::free) grains.push_back(slot);
    list_neighbours();
  }

  Point point(const Vector3& position) const {
    const Vector3 at = (position - low) * quanta;
    const auto wrap = [](double number) {
      return static_cast<std::int32_t>(static_cast<std::uint64_t>(std::llround(number)));
    };
    return {wrap(at.x()), wrap(at.y()), wrap(at.z()), Point::free};
  }

  std::array<int, 3> coordinates(const Vector3& position) const {
    std::array<int, 3> all;
    for (int axis = 0; axis < 3; ++axis)
      all[axis] = std::clamp(static_cast<int>((position[axis] - low[axis]) / edge), 0, cells[axis] - 1);
    return all;
  }

  std::uint32_t cell(const Vector3& position) const {
    const auto [x, y, z] = coordinates(position);
    return static_cast<std::uint32_t>((z * cells[1] + y) * cells[0] + x);
  }

  /// Ranges of slots, one a row of cells, of the box around a sphere.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> rows(const Vector3& centre, double range) const {
    const Vector3 corner(range, range, range);
    const auto first = coordinates(centre - corner), last = coordinates(centre + corner);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y) {
        const auto row = static_cast<std::uint32_t>((z * cells[1] + y) * cells[0]);
        all.emplace_back((row + static_cast<std::uint32_t>(first[0])) * slots,
                         (static_cast<std::uint32_t>(last[0] - first[0]) + 1) * slots);
      }
    return all;
  }

  void list_neighbours() {
    std::vector<std::uint32_t> found(points.size());
    for (const spot::Grain& grain : ::grains()) {
      const Point centre = point(grain.position);
      std::vector<std::uint32_t> near;
      std::uint32_t own = 0;
      for (const auto& [first, n] : rows(grain.position, reach)) {
        const auto count = spot::kernels::best().find_within(
            points.data() + first, n, centre, static_cast<float>(reach * reach * quanta * quanta), first, found.data());
        near.insert(near.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
      }
      for (const std::uint32_t slot : near)
        if (points[slot].x == centre.x && points[slot].y == centre.y && points[slot].z == centre.z) own = slot;
      for (const std::uint32_t slot : near)
        if (slot != own && list_size[own] < list_capacity) lists[own * list_capacity + list_size[own]++] = slot;
    }
  }
};

const Tiles& tiles() {
  static const Tiles all;
  return all;
}

/// Middles of moves in the column above the orifice, where spots are.
std::vector<Vector3> middles(std::size_t n) {
  std::vector<Vector3> all;
  std::uint64_t draw = 1;
  const auto uniform = [&draw](double from, double to) {
    draw = draw * 6364136223846793005u + 1442695040888963407u;
    return from + (to - from) * static_cast<double>(draw >> 11) / 9007199254740992.0;
  };
  while (all.size() < n) all.emplace_back(uniform(-12, 12), uniform(-3, 3), uniform(5, 100));
  return all;
}

template <typename Kernel>
void per_sphere(benchmark::State& state, double range, Kernel kernel) {
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> rows;
  std::vector<Point> centres;
  for (const Vector3& middle : middles(1024)) {
    rows.push_back(tiles().rows(middle, range));
    centres.push_back(tiles().point(middle));
  }
  std::size_t turn = 0, found = 0;
  for (auto _ : state) {
    const std::size_t place = turn % rows.size(), round = turn / rows.size();
    for (const auto& [first, n] : rows[place]) found += kernel(first, n, centres[place], round);
    ++turn;
  }
  benchmark::DoNotOptimize(found);
  state.counters["grains"] = benchmark::Counter(static_cast<double>(found), benchmark::Counter::kAvgIterations);
}

/// The places around the middles of moves.
void per_move(benchmark::State& state,
              const std::function<std::size_t(const spot::kernels::Places&, const Point&, std::size_t)>& kernel) {
  constexpr std::size_t lanes = spot::kernels::lanes;
  const std::size_t blocks = (tiles().points.size() + lanes - 1) / lanes;
  spot::Coordinates at;
  for (auto* values : {&at.x, &at.y, &at.z}) values->resize(blocks * lanes);
  at.state_squared.assign(blocks * lanes, 1e30f);
  for (std::size_t slot = 0; slot < tiles().points.size(); ++slot) at.set(slot, tiles().points[slot]);
  std::vector<std::vector<std::uint32_t>> reached;
  std::vector<Point> centres;
  for (const Vector3& middle : middles(1024)) {
    reached.emplace_back();
    for (const auto& [first, n] : tiles().rows(middle, radius))
      for (std::size_t block = first / lanes; block * lanes < first + n; ++block)
        reached.back().push_back(static_cast<std::uint32_t>(block));
    centres.push_back(tiles().point(middle));
  }
  std::size_t turn = 0, found = 0;
  for (auto _ : state) {
    const std::size_t move = turn % reached.size(), round = turn / reached.size();
    found += kernel(
        {at.x.data(), at.y.data(), at.z.data(), at.state_squared.data(), reached[move].data(), reached[move].size()},
        centres[move], round);
    ++turn;
  }
  benchmark::DoNotOptimize(found);
  state.counters["grains"] = benchmark::Counter(static_cast<double>(found), benchmark::Counter::kAvgIterations);
}

/// A move; every second round grains go back, so that the packing stays.
void displace(benchmark::State& state, const Kernels& kernels) {
  const auto radius_squared = static_cast<float>(radius * radius * quanta * quanta);
  per_move(state, [&](const spot::kernels::Places& places, const Point& centre, std::size_t round) {
    const std::int32_t sign = round % 2 == 0 ? 1 : -1;
    kernels.displace(places, centre, {radius_squared, 1.0f / radius_squared}, {sign * 80000, 0, -sign * 33000, 0});
    return places.count * spot::kernels::lanes;
  });
}

/// The shares in a move.
void enclosed_volume(benchmark::State& state, const Kernels& kernels) {
  const auto radius_squared = static_cast<float>(radius * radius * quanta * quanta);
  per_move(state, [&](const spot::kernels::Places& places, const Point& centre, std::size_t) {
    return static_cast<std::size_t>(kernels.enclosed_volume(places, centre, {radius_squared, 1.0f / radius_squared})) /
           spot::grain_volume;
  });
}

/// The neighbours of one place.
void find_within(benchmark::State& state, const Kernels& kernels) {
  std::vector<std::uint32_t> out(tiles().points.size());
  const auto reach_squared = static_cast<float>(Tiles::reach * Tiles::reach * quanta * quanta);
  per_sphere(state, Tiles::reach, [&](std::uint32_t first, std::uint32_t n, const Point& centre, std::size_t) {
    return kernels.find_within(tiles().points.data() + first, n, centre, reach_squared, first, out.data());
  });
}

/// A sweep over all grains.
void push_off_neighbours(benchmark::State& state, const Kernels& kernels) {
  const Tiles& all = tiles();
  std::vector<Point> pushes(all.grains.size());
  std::vector<std::uint32_t> grains = all.grains;
  grains.resize(grains.size() + spot::kernels::ahead, 0);
  for (auto _ : state) {
    kernels.push_off_neighbours(all.points.data(), grains.data(), all.grains.size(),
                                {all.lists.data(), all.blocks.data(), all.list_size.data()},
                                {static_cast<float>(1.0 / (quanta * quanta)), 0.4f, 0.8f}, pushes.data());
    benchmark::DoNotOptimize(pushes.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(all.grains.size()));
}

/// One cell of eight slots.
void farthest(benchmark::State& state, const Kernels& kernels) {
  spot::AlignedVector<Point> moved = tiles().points;
  for (Point& point : moved) point.x += 1000;
  std::size_t place = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(kernels.farthest(tiles().points.data() + place, moved.data() + place, Tiles::slots));
    place = (place + Tiles::slots) % moved.size();
  }
}

/// The unrelaxed moves of all cells, of which one in ten has to be swept.
void find_reached(benchmark::State& state, const Kernels& kernels) {
  std::vector<std::int32_t> unrelaxed(tiles().points.size() / Tiles::slots);
  for (std::size_t k = 0; k < unrelaxed.size(); ++k) unrelaxed[k] = k % 10 == 0 ? 9 : 1;
  std::vector<std::uint32_t> found(unrelaxed.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(kernels.find_reached(unrelaxed.data(), unrelaxed.size(), 9, found.data()));
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(unrelaxed.size()));
}

// ---- moves and sweeps, with the instruction set that SPOT_INSTRUCTION_SET names, or the best

struct Silo {
  std::shared_ptr<const spot::Container> container =
      spot::box_silo(-25, 25, -4, 4, spot::Orifice{Vector3::Zero(), 4.0}, spot::SpotBuffers{1.0, 1.0});
  spot::Workers workers{1};
  spot::TiledPacking packing{1.0, 200.0, 0.0, grains(), *container};
};

/// Moves of a window, with all that TiledPacking does for one: finding its cells, charging them, keeping lists up to
/// date.
void moves_of_a_window(benchmark::State& state) {
  Silo silo;
  const auto n = static_cast<std::size_t>(state.range(0));
  const double dx = spot::step_width_for(diffusion_length, step_height);
  spot::SpotParameters spots{radius, influence};
  spots.profile = spot::InfluenceProfile::parabolic;
  std::vector<std::vector<spot::Move>> windows(16);
  std::size_t volume_moved = 0;
  const auto weigh = [&volume_moved](const std::vector<int>& shares, std::vector<spot::Move>&) {
    for (const int share : shares) volume_moved += static_cast<std::size_t>(share);
  };
  const auto places = middles(n * windows.size() / 2);
  for (std::size_t k = 0; k < places.size(); ++k) {
    spot::Move move{};
    move.middle = places[k];
    move.step = Vector3(k % 2 == 0 ? dx : -dx, 0.0, step_height);
    windows[k / n * 2].push_back(move);
    // And back, so that the packing stays what it is.
    move.step = -move.step;
    windows[k / n * 2 + 1].push_back(move);
  }
  std::size_t window = 0;
  for (auto _ : state) {
    silo.packing.displace(windows[window], spots, weigh, *silo.container, silo.workers);
    window = (window + 1) % windows.size();
  }
  const auto moves = static_cast<double>(state.iterations()) * static_cast<double>(n);
  state.SetItemsProcessed(static_cast<std::int64_t>(moves));
  state.counters["grains_per_move"] = static_cast<double>(volume_moved) / spot::grain_volume / moves;
}

/// Sweeps over all cells, with collecting the grains, walls and applying the pushes.
void sweep_over_all(benchmark::State& state) {
  Silo silo;
  spot::RelaxationParameters parameters;
  parameters.alpha = 1.2;
  parameters.momentum = 0.7;
  std::size_t swept = 0;
  spot::CellRelaxation relaxation(silo.packing, parameters);
  for (auto _ : state)  // of all cells
    swept += relaxation.sweep(0, 1.0, *silo.container, silo.workers);
  state.SetItemsProcessed(static_cast<std::int64_t>(swept));
  state.counters["bytes_per_grain"] =
      static_cast<double>(silo.packing.memory()) / static_cast<double>(silo.packing.size());
}

void register_kernels(const Kernels& kernels) {
  const auto add = [&kernels](const char* name, void (*run)(benchmark::State&, const Kernels&)) {
    benchmark::RegisterBenchmark((std::string(name) + "/" + kernels.instruction_set).c_str(),
                                 [run, &kernels](benchmark::State& state) { run(state, kernels); });
  };
  add("displace_a_move", displace);
  add("shares_in_a_move", enclosed_volume);
  add("find_within_a_sphere", find_within);
  add("push_off_all_neighbours", push_off_neighbours);
  add("farthest_in_a_cell", farthest);
  add("find_reached_in_all_cells", find_reached);
}

}  // namespace

int main(int argc, char** argv) try {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  for (const Kernels* build : spot::kernels::runnable()) register_kernels(*build);
  const std::string best = spot::kernels::best().instruction_set;
  benchmark::RegisterBenchmark(("TiledPacking_displace_window/" + best).c_str(), moves_of_a_window)
      ->Arg(100)
      ->Arg(2000);
  benchmark::RegisterBenchmark(("TiledPacking_sweep/" + best).c_str(), sweep_over_all);
  benchmark::RunSpecifiedBenchmarks();
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
