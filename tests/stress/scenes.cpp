// SPDX-License-Identifier: GPL-2.0-or-later
// Drains silos of random shape, with random outlets, schedules, periods and sizes of grains, on 1 and on 3 workers.
//
//   stress-scenes N [FIRST]     the scenes FIRST (1) to FIRST + N - 1
//
// Ends with an error, naming the scene, if a grain or a spot is outside or lost, or the bits are not the same.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>

#include "general_scene.hpp"
#include "invariants.hpp"
#include "spot/drivers/recirculation.hpp"
#include "spot/geometry/repeated_solid.hpp"
#include "spot/geometry/shaped_container.hpp"
#include "spot/geometry/shapes.hpp"
#include "spot/geometry/slot.hpp"

namespace {

using scenes::Draws;
using spot::Solid;
using spot::Vector3;

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double height = 60.0;  // of all silos: open at the top

/// A silo and what it is called. Lengths in diameters.
struct Shape {
  std::string name;
  Solid solid;
  spot::Periodic periodic;
  std::vector<spot::Outlet> outlets;
  Vector3 low, high;  // where grains may be
};

spot::Outlet drawn_outlet(Draws& draws, const Vector3& centre, double radius) {
  if (draws.below(2) == 0) return spot::Orifice{centre, radius};
  return {centre, std::make_shared<spot::Slot>(2.0 * radius, 2.0 * radius * draws.uniform(0.8, 1.0))};
}

/// Of one to three outlets side by side, a sphere or a beam in it maybe, repeating along x, y or both maybe.
Shape block(Draws& draws, double radius) {
  const std::size_t outlets = 1 + draws.below(3);
  const double pitch = 2.0 * radius + 1.0, width = 0.5 * pitch * static_cast<double>(outlets) + draws.uniform(2.0, 4.0),
               depth = radius + draws.uniform(2.5, 4.0), top = draws.uniform(6.0, 11.0);
  const bool along_x = draws.below(2) == 0, along_y = draws.below(2) == 0;
  const spot::Interval x{-width, width}, y{-depth, depth};
  const spot::Periodic periodic(along_x ? std::optional(x) : std::nullopt, along_y ? std::optional(y) : std::nullopt);
  const Vector3 low(-width, -depth, 0.0), high(width, depth, height);
  Solid solid = spot::repeated(spot::block(low, high), low, high, periodic);
  std::string name = "block";
  if (const std::size_t insert = draws.below(3); insert > 0) {
    const Vector3 centre(0.0, 0.0, radius + 4.5),
        half = insert == 1 ? Vector3(1.2, 1.2, 1.2) : Vector3(1.0, depth, 0.3);
    const Solid cut = insert == 1 ? spot::sphere(centre, 1.2) : spot::block(centre - half, centre + half);
    solid = solid & ~spot::repeated(cut, centre - half, centre + half, periodic);
    name += insert == 1 ? " less a sphere" : " less a beam";
  }
  Shape shape{name, solid, periodic, {}, low, {width, depth, top}};
  for (std::size_t k = 0; k < outlets; ++k) {
    const double at = pitch * (static_cast<double>(k) - 0.5 * static_cast<double>(outlets - 1));
    shape.outlets.push_back(drawn_outlet(draws, {at, 0.0, 0.0}, radius));
  }
  return shape;
}

/// An upright one, or a cone below it.
Shape round(Draws& draws, double radius) {
  const double side = radius + draws.uniform(2.0, 5.0), top = draws.uniform(7.0, 12.0);
  const Vector3 centre(0.0, 0.0, 0.0), up(0.0, 0.0, height);
  Shape shape{"cylinder", spot::cylinder_between(centre, up, side), {}, {}, {-side, -side, 0.0}, {side, side, top}};
  if (draws.below(3) > 0) {
    const Vector3 shoulder(0.0, 0.0, (side - radius) * draws.uniform(0.5, 2.0));
    shape.name = "cone and cylinder";
    shape.solid = spot::cone_between(centre, radius, shoulder, side) | spot::cylinder_between(shoulder, up, side);
    shape.outlets.emplace_back(spot::Orifice{centre, radius});
  } else {
    shape.outlets.push_back(drawn_outlet(draws, centre, radius));
  }
  return shape;
}

/// A block less two planes, above a slot; between walls, or as a slice that repeats.
Shape wedge(Draws& draws, double radius) {
  const double width = radius + draws.uniform(2.0, 5.0), depth = radius + draws.uniform(2.5, 4.0),
               slope = draws.uniform(0.5, 2.0), top = draws.uniform(7.0, 12.0);
  const bool slice = draws.below(2) == 0;
  const spot::Periodic periodic(std::nullopt, slice ? std::optional(spot::Interval{-depth, depth}) : std::nullopt);
  const Vector3 low(-width, -depth, 0.0), high(width, depth, height), far = Vector3::Constant(endless);
  const auto side = [&](double sign) {
    return ~spot::repeated(spot::half_space({sign * radius, 0.0, 0.0}, {sign, 0.0, -slope}), -far, far, periodic);
  };
  const Solid solid = spot::repeated(spot::block(low, high), low, high, periodic) & side(1.0) & side(-1.0);
  const double length = slice ? 2.0 * depth : 2.0 * radius;
  return {slice ? "slice of a wedge" : "wedge",
          solid,
          periodic,
          {{{0.0, 0.0, 0.0}, std::make_shared<spot::Slot>(2.0 * radius, length)}},
          low,
          {width, depth, top}};
}

/// All that a run is made of, drawn from a seed.
struct Scene {
  explicit Scene(std::uint64_t seed);

  std::unique_ptr<spot::WindowedDrainage> start(int workers) const {
    return std::make_unique<spot::WindowedDrainage>(spots, relaxation, limits, 0.02, workers, silo, 1.0, 100.0, grains);
  }

  void draw_critical(Draws& draws);

  Shape shape;
  std::shared_ptr<const spot::Container> silo;
  spot::SpotParameters spots;
  spot::RelaxationParameters relaxation;
  spot::DrainageLimits limits{0.0};
  std::vector<spot::Grain> grains;
  bool equal, recirculates;
};

Shape drawn_shape(Draws& draws, double radius) {
  const std::size_t kind = draws.below(3);
  return kind == 0 ? block(draws, radius) : kind == 1 ? round(draws, radius) : wedge(draws, radius);
}

spot::Injection drawn_rates(Draws& draws, std::size_t outlets) {
  std::vector<spot::RateSchedule> rates;
  for (std::size_t k = 0; k < outlets; ++k) {
    const double rate = draws.uniform(200.0, 800.0);
    std::vector<spot::RateStep> steps = {{0.0, rate}};
    if (draws.below(2) == 0) steps.push_back({draws.uniform(0.1, 0.4), rate * static_cast<double>(draws.below(3))});
    rates.emplace_back(steps);
  }
  return spot::Injection(rates);
}

Scene::Scene(std::uint64_t seed)
    : shape([seed] {
        Draws draws(seed);
        return drawn_shape(draws, draws.uniform(1.6, 2.4));
      }()) {
  Draws draws(seed + 0x1p40);
  const spot::Outlets outlets = spot::Outlets(shape.outlets).repeated(shape.periodic);
  silo = std::make_shared<spot::ShapedContainer>(shape.solid, outlets, spot::SpotBuffers{0.25, draws.uniform(0.0, 2.0)},
                                                 shape.periodic);
  equal = draws.below(4) == 0;
  recirculates = draws.below(4) == 0;
  const double volume = (shape.high - shape.low).prod();
  for (const spot::Grain& grain :
       scenes::unequal_grains(static_cast<std::size_t>((equal ? 0.7 : 1.4) * volume), shape.low, shape.high,
                              shape.periodic, draws.below(1u << 30), 1.0, equal)) {
    spot::WallContacts walls;
    if (silo->contains(grain.position)) silo->contacts(grain.position, grain.radius, walls);
    if (silo->contains(grain.position) && walls.begin() == walls.end()) grains.push_back(grain);
  }
  spots.radius = draws.uniform(1.0, 1.6);
  spots.influence = draws.uniform(0.005, 0.02);
  spots.step_height = draws.uniform(0.1, 0.6);
  spots.step_width = draws.uniform(0.2, 1.2);
  spots.speed = 3.0;
  spots.seed = seed;
  spots.injection_rate = drawn_rates(draws, shape.outlets.size());
  spots.profile = spot::InfluenceProfile::parabolic;
  if (draws.below(2) == 0) spots.fixed_volume = 2.5 * std::pow(spots.radius, 3);
  spots.holds_outflow = draws.below(2) == 0;
  if (draws.below(2) == 0) spots.dilation = draws.uniform(0.01, 0.2);
  if (draws.below(2) == 0) spots.surface_exponent = draws.uniform(0.5, 6.0);
  if (draws.below(2) == 0) spots.nonaffine = 0.15, spots.nonaffine_length = 0.5;
  if (draws.below(2) == 0 && spots.fixed_volume > 0.0) spots.spread = 0.6, spots.wall_shear = 0.7;
  relaxation.momentum = 0.6;
  relaxation.tolerance = 2e-3;
  // Drawn last, so that all else in a scene is as it was before.
  if (draws.below(2) == 0 && spots.fixed_volume > 0.0) draw_critical(draws);
  const double held = draws.below(3) == 0 ? 0.03 : 0.0;
  for (spot::Grain& grain : grains) grain.held = draws.uniform(0.0, 1.0) < held;
  if (spots.holds_outflow && draws.below(2) == 0) spots.fade = draws.uniform(0.1, 2.0);
  if (spots.spread > 0.0 && draws.below(2) == 0) spots.mobility = {0.2, 0.5, 3.0};
  if (spots.critical_fraction > 0.0 && draws.below(2) == 0) spots.full_strain = draws.uniform(0.01, 3.0) / spots.radius;
}

/// The bed is looser than any that flows, which is refused: so it is too shallow to be checked.
void Scene::draw_critical(Draws& draws) {
  spots.critical_fraction = draws.uniform(0.5, 0.6);
  spots.exchange_length = spots.step_height * draws.uniform(0.2, 5.0);
  if (draws.below(2) == 0) spots.dilatancy = spots.radius * draws.uniform(0.02, 0.33);
  const double top = 3.0 * spots.radius + 2.0;
  grains.erase(
      std::remove_if(grains.begin(), grains.end(), [top](const auto& grain) { return grain.position.z() > top; }),
      grains.end());
}

struct Count {
  std::size_t drained = 0, put_back = 0, moves = 0, critical = 0, held = 0;
};

std::string wrong_spot(const spot::Drainage& drainage, const spot::Container& silo) {
  for (const spot::Spot& spot : drainage.spots())
    if (spot.position.z() > silo.outlets().height() && !silo.contains(spot.position))
      return spot::message("spot ", spot.id, " is outside, at (", spot.position.transpose(), ")");
  return {};
}

/// Drains it on 1 and on 3 workers; what is wrong, or nothing.
std::string drain(const Scene& scene, Count& count) {
  const auto one = scene.start(1), three = scene.start(3);
  invariants::Ledger ledger(scene.grains, 1.0, scene.limits, *scene.silo);
  spot::Inlet inlet{scene.shape.low, scene.shape.high + Vector3(0.0, 0.0, 40.0), true, {}, "the top"};
  const spot::Recirculation recirculation(scene.spots.seed, inlet, scene.silo, 1.0);
  spot::Alone alone;
  for (int k = 1; k <= 4; ++k) {
    for (auto* drainage : {one.get(), three.get()}) {
      drainage->advance_to(0.2 * k);
      if (!scene.recirculates) continue;
      const auto drained = drainage->take_drained();
      recirculation.put_back(*drainage, drained, k, alone);
      drainage->require_inside();
      if (drainage == one.get()) count.put_back += drained.size();
    }
    if (const std::string wrong = wrong_spot(*one, *scene.silo); !wrong.empty()) return wrong;
    if (one->grains() != three->grains()) return "3 workers give other bits";
    if (scene.recirculates && one->grains().size() != scene.grains.size()) return "grains that go round were lost";
    if (const std::string wrong = scene.recirculates ? "" : ledger.check(*one); !wrong.empty()) return wrong;
  }
  count.drained += ledger.drained();
  count.moves += static_cast<std::size_t>(one->counters().moves);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3 || std::atoll(argv[1]) < 1 || (argc == 3 && std::atoll(argv[2]) < 1)) {
    std::cerr << "stress-scenes N [FIRST]: both whole numbers, 1 or more\n";
    return 2;
  }
  const auto first = static_cast<std::uint64_t>(argc == 3 ? std::atoll(argv[2]) : 1);
  const std::uint64_t end = first + static_cast<std::uint64_t>(std::atoll(argv[1]));
  Count count;
  std::map<std::string, std::size_t> shapes, refused;
  std::size_t wrong = 0;
  for (std::uint64_t seed = first; seed < end; ++seed) {
    std::string what = "it could not be drawn";
    try {
      const Scene scene(seed);
      ++shapes[scene.shape.name];
      count.critical += scene.spots.critical_fraction > 0.0;
      count.held += std::any_of(scene.grains.begin(), scene.grains.end(), [](const auto& grain) { return grain.held; });
      what = drain(scene, count);
    } catch (const spot::CollapsedPacking&) {
      ++refused["collapsed packings"];
      continue;
    } catch (const spot::Error& error) {
      what = error.what();
    }
    if (what.empty()) continue;
    ++wrong;
    std::cout << "scene " << seed << ": " << what << std::endl;
  }
  std::cout << end - first << " scenes, " << wrong << " wrong, " << count.drained << " grains drained, "
            << count.put_back << " put back, " << count.moves << " moves; " << count.critical << " with critical, "
            << count.held << " with held grains\n";
  for (const auto& [name, n] : shapes) std::cout << "  " << n << " " << name << '\n';
  for (const auto& [name, n] : refused) std::cout << "  " << n << " " << name << '\n';
  return wrong == 0 ? 0 : 1;
}
