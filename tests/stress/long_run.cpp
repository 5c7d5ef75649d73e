// SPDX-License-Identifier: GPL-2.0-or-later
// Drains a small silo for as many spot moves as one likes; grains that leave are put back on top. Says how the packing
// drifts, and ends with an error if it does.
//
//   stress-long-run [MOVES [THREADS]]     1e7 moves, besides a warm-up, unless it is given
#include <array>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>

#include "stress.hpp"

namespace {

using spot::Grain;
using spot::Vector3;

constexpr double refill_every = 1.0;  // tau; 5 % of the grains
constexpr int warm_up = 150;          // refills; by then the grains that were put on top are packed all the way down
constexpr std::size_t lines = 20;     // of the report

/// Where a grain may come to lie on what is there: the lowest place over some columns drawn at random.
Vector3 place_on_top(const std::vector<Grain>& grains, const stress::Scene& scene, scenes::Draws& draws) {
  Vector3 best(0.0, 0.0, std::numeric_limits<double>::max());
  for (int attempt = 0; attempt < 20; ++attempt) {
    Vector3 place = draws.in_box({0.5 - scene.half_width, 0.5 - scene.half_depth, 0.5},
                                 {scene.half_width - 0.5, scene.half_depth - 0.5, 0.5});
    place.z() = 0.5;
    for (const Grain& grain : grains) {
      const double squared = (grain.position - place).head<2>().squaredNorm();
      if (squared < 1.0) place.z() = std::max(place.z(), grain.position.z() + std::sqrt(1.0 - squared));
    }
    if (place.z() < best.z()) best = place;
  }
  return best;
}

/// The drained grains go back on top.
void refill(spot::Drainage& drainage, const stress::Scene& scene, scenes::Draws& draws) {
  std::vector<Grain> grains = drainage.grains();
  for (Grain grain : drainage.take_drained()) {
    grain.position = place_on_top(grains, scene, draws);
    grains.push_back(grain);
  }
  drainage.replace_grains(grains);
}

/// Share of the volume that is grains, away from walls, orifice and surface, as well as counting centres tells.
double packing_fraction(const std::vector<Grain>& grains) {
  const auto inside = std::count_if(grains.begin(), grains.end(), [](const Grain& grain) {
    const Vector3& p = grain.position;
    return std::abs(p.x()) < 4.0 && std::abs(p.y()) < 2.0 && p.z() > 3.0 && p.z() < 11.0;
  });
  return static_cast<double>(inside) * scenes::pi / 6.0 / (8.0 * 4.0 * 8.0);
}

using Bonds = std::array<std::complex<double>, 13>;  // q_6m of a grain, of length 1

Bonds bonds_of(const std::vector<Grain>& grains, std::size_t i, const std::vector<std::size_t>& near) {
  Bonds bonds{};
  for (const std::size_t j : near) {
    const Vector3 bond = (grains[j].position - grains[i].position).normalized();
    for (unsigned m = 0; m <= 6; ++m) {
      const double part = std::sph_legendre(6, m, std::acos(bond.z()));
      const std::complex<double> y = part * std::polar(1.0, m * std::atan2(bond.y(), bond.x()));
      bonds[6 + m] += y;
      if (m > 0) bonds[6 - m] += (m % 2 == 0 ? 1.0 : -1.0) * std::conj(y);
    }
  }
  double squared = 0.0;
  for (const auto& q : bonds) squared += std::norm(q);
  for (auto& q : bonds) q /= std::sqrt(std::max(squared, 1e-300));
  return bonds;
}

/// Share of grains with seven or more neighbours (closer than 1.4 d) whose q_6 is like their own, to 0.7 (ten Wolde).
double crystalline_share(const std::vector<Grain>& grains) {
  std::vector<std::vector<std::size_t>> near(grains.size());
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (std::size_t j = 0; j < grains.size(); ++j)
      if (i != j && (grains[i].position - grains[j].position).squaredNorm() < 1.4 * 1.4) near[i].push_back(j);
  std::vector<Bonds> bonds;
  for (std::size_t i = 0; i < grains.size(); ++i) bonds.push_back(bonds_of(grains, i, near[i]));
  std::size_t crystalline = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    int alike = 0;
    for (const std::size_t j : near[i]) {
      std::complex<double> product = 0.0;
      for (std::size_t m = 0; m < bonds[i].size(); ++m) product += bonds[i][m] * std::conj(bonds[j][m]);
      if (product.real() > 0.7) ++alike;
    }
    if (alike >= 7) ++crystalline;
  }
  return static_cast<double>(crystalline) / static_cast<double>(grains.size());
}

/// Sums over the refills of one line of the report.
struct Line {
  int n = 0;
  double badness = 0.0, fraction = 0.0, largest = 0.0;
  double crystalline = 0.0;  // at the end

  void add(const std::vector<Grain>& grains) {
    const invariants::Overlaps overlaps = invariants::overlaps_of(grains, 1.0);
    ++n;
    badness += overlaps.badness;
    fraction += packing_fraction(grains);
    largest = std::max(largest, overlaps.largest);
  }
};

void print(const Line& line, const spot::Counters& counters, double time) {
  const double seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;  // of the processor
  const auto moves = static_cast<double>(counters.moves);
  std::printf("| %.3g | %.0f | %lld | %.2e | %.4f | %.3f | %.3f | %.1e |\n", moves, time,
              static_cast<long long>(counters.drained), line.badness / line.n, line.fraction / line.n, line.largest,
              line.crystalline, moves / seconds);
  std::fflush(stdout);
}

/// The mean of one half of the report.
template <typename Value>
double mean(const std::vector<Line>& report, std::size_t first, Value value) {
  double sum = 0.0;
  for (std::size_t k = first; k < first + lines / 2; ++k) sum += value(report[k]);
  return sum / static_cast<double>(lines / 2);
}

/// By how much the second half of a run may differ from the first.
struct Bounds {
  double badness, fraction, crystalline;  // the first relative
};

/// Of few moves means are rough.
Bounds bounds_for(double moves) { return moves < 1e7 ? Bounds{0.4, 0.01, 0.05} : Bounds{0.05, 0.002, 0.02}; }

/// Nothing may drift.
int judge(const std::vector<Line>& report, const Bounds& bounds) {
  const auto badness = [](const Line& line) { return line.badness / line.n; };
  const auto fraction = [](const Line& line) { return line.fraction / line.n; };
  const double ratio = mean(report, lines / 2, badness) / mean(report, 0, badness);
  const double change = mean(report, lines / 2, fraction) - mean(report, 0, fraction);
  const auto crystalline = [](const Line& line) { return line.crystalline; };
  const double order = mean(report, lines / 2, crystalline) - mean(report, 0, crystalline);
  std::printf(
      "second half less first half: B %+.1f %% (at most %g), packing fraction %+.4f (%g), crystal-like %+.4f (%g)\n",
      100.0 * (ratio - 1.0), 100.0 * bounds.badness, change, bounds.fraction, order, bounds.crystalline);
  return std::abs(ratio - 1.0) < bounds.badness && std::abs(change) < bounds.fraction &&
                 std::abs(order) < bounds.crystalline
             ? 0
             : 1;
}

int run(double moves, int threads) {
  stress::Scene scene;
  scene.fill(16.0);
  scene.spots.critical_fraction = 0.55;  // 0.526 with what walls shear off it, where the packing has 0.54 at rest
  scene.threads = threads;
  const auto drainage = scene.start();
  scenes::Draws draws(1);
  std::vector<Line> report(1);
  double before = 0.0;  // moves of the warm-up
  std::puts(
      "| moves | time (tau) | grains put back | B | packing fraction | largest overlap (d) | crystal-like | moves per "
      "processor second |");
  std::puts("|---|---|---|---|---|---|---|---|");
  for (std::int64_t k = 1; report.size() <= lines; ++k) {
    const double time = refill_every * static_cast<double>(k);
    drainage->advance_to(time);
    drainage->require_inside();
    const std::vector<Grain> grains = drainage->grains();
    if (k > warm_up) report.back().add(grains);
    refill(*drainage, scene, draws);
    if (drainage->grains().size() != scene.grains.size()) throw spot::InvalidPacking("grains were lost or made");
    const auto done = static_cast<double>(drainage->counters().moves);
    if (k <= warm_up) before = done;
    if (k <= warm_up || done - before < moves * static_cast<double>(report.size()) / lines) continue;
    report.back().crystalline = crystalline_share(grains);
    print(report.back(), drainage->counters(), time);
    report.emplace_back();
  }
  return judge(report, bounds_for(moves));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc > 1 ? std::atof(argv[1]) : 1e7, argc > 2 ? std::atoi(argv[2]) : 1);
  } catch (const spot::Error& error) {
    std::printf("error: %s\n", error.what());
    return 1;
  }
}
