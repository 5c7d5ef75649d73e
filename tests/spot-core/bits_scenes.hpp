// SPDX-License-Identifier: GPL-2.0-or-later
// The scenes of which bits_test.cpp pins the bits: each small, together all that a drainage can do.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "named.hpp"
#include "scenes.hpp"
#include "spot/drivers/drainage.hpp"

namespace scenes {

/// What somebody else does to a drainage at this time, which is a whole number of windows.
struct Change {
  double time;
  spot::GrainChanges grains;
  std::shared_ptr<const spot::Container> container;  // or null: the same as before
};

struct PinnedScene {
  bool time_ordered = false;
  spot::SpotParameters spots;
  spot::RelaxationParameters relaxation;
  spot::DrainageLimits limits{-1.0};
  std::shared_ptr<const spot::Container> container;
  double diameter = 1.0, extent = 100.0;
  std::vector<spot::Grain> grains;
  double window = 0.05, end = 1.5;
  std::vector<Change> changes;
  bool counts_moves = false;  // of each grain
};

using NamedScene = Named<PinnedScene>;

/// All of them; names say what each adds to spots that carry a volume of 2006 through a box.
class PinnedScenes {
 public:
  PinnedScenes() {
    add_to_both_drivers(false);
    add_to_both_drivers(true);
    add_windowed();
    add_time_ordered();
    for (const bool time_ordered : {false, true}) {
      add(time_ordered, "all-ingredients", all_ingredients);
      add(time_ordered, "spread", spreading);
      add(time_ordered, "outflow", holding_outflow);
      add(time_ordered, "fade", fading);
      add(time_ordered, "mobility", mobile);
      add(time_ordered, "full-strain", exchanging_where_strained);
    }
  }
  const std::vector<NamedScene>& all() const { return all_; }

 private:
  static constexpr double half_width = 5.0, half_depth = 4.0;

  static std::vector<spot::Grain> filling(double height) {
    return dense_grains({0.5 - half_width, 0.5 - half_depth, 0.5}, {half_width - 0.5, half_depth - 0.5, height}, 0.01,
                        2);
  }

  static PinnedScene plain(bool time_ordered) {
    PinnedScene scene;
    scene.time_ordered = time_ordered;
    scene.spots = paper_spots();
    scene.spots.influence = 1e-2;
    scene.spots.step_height = 0.8;
    scene.spots.step_width = spot::step_width_for(1.25, scene.spots.step_height);
    scene.spots.injection_rate = 100.0;
    scene.relaxation.tolerance = 3e-3;
    scene.container = small_silo(half_width, half_depth);
    scene.grains = filling(time_ordered ? 8.0 : 10.0);
    if (time_ordered) scene.end = 2.4;
    return scene;
  }

  void add(bool time_ordered, const std::string& name, const std::function<void(PinnedScene&)>& alter) {
    all_.push_back({(time_ordered ? "time-ordered-" : "windowed-") + name, [time_ordered, alter] {
                      PinnedScene scene = plain(time_ordered);
                      alter(scene);
                      return scene;
                    }});
  }

  static void into_cylinder(PinnedScene& scene) {
    scene.container = spot::cylinder_silo(0.0, 0.0, half_width, spot::Orifice{{0.0, 0.0, 0.0}, 4.0}, {1.0, 2.6});
    std::vector<spot::Grain> inside;
    for (spot::Grain grain : dense_grains({-4.5, -4.5, 0.5}, {4.5, 4.5, scene.time_ordered ? 8.0 : 10.0}, 0.01, 3))
      if (grain.position.head<2>().norm() <= half_width - 0.5) inside.push_back(grain);
    scene.grains = std::move(inside);
  }

  /// All at once that can be together, as the example of a silo has it.
  static void all_at_once(PinnedScene& scene) {
    scene.spots.profile = spot::InfluenceProfile::parabolic;
    scene.spots.radius = 3.53;
    scene.spots.fixed_volume = 77.0;
    scene.spots.persistence = 0.3;
    scene.spots.step_width = spot::step_width_for(1.4, scene.spots.step_height, 0.3);
    scene.spots.dilation = 0.03;
    scene.spots.speed = 2.5;
    scene.relaxation.momentum = 0.8;
    scene.relaxation.contact_overlap = 1.5e-3;
    scene.counts_moves = true;
  }

  /// Spots that leave volume behind and see the surface, and grains that go ways of their own; spots climb to where
  /// they do so, in a taller filling.
  static void all_ingredients(PinnedScene& scene) {
    all_at_once(scene);
    scene.spots.critical_fraction = 0.54;  // the filling has 0.547
    scene.spots.exchange_length = 1.0;
    scene.spots.dilatancy = 0.2;
    scene.spots.nonaffine = 0.15;
    scene.spots.nonaffine_length = 0.5;
    scene.spots.surface_exponent = 3.0;
    scene.spots.speed = 5.0;
    scene.spots.injection_rate = 60.0;
    scene.grains = filling(14.0);
    scene.end = 3.0;
  }

  /// With all else, but for a persistence.
  static void spreading(PinnedScene& scene) {
    all_ingredients(scene);
    scene.spots.persistence = 0.0;
    scene.spots.step_width = spot::step_width_for(1.4, scene.spots.step_height);
    scene.spots.spread = 0.6;
    scene.spots.wall_shear = 0.7;
  }

  /// So long that births follow it a few times, from what has left before, too.
  static void holding_outflow(PinnedScene& scene) {
    spreading(scene);
    scene.spots.holds_outflow = true;
  }

  /// So strongly that a bed of that depth has it, too.
  static void fading(PinnedScene& scene) {
    holding_outflow(scene);
    scene.spots.fade = 2.0;
  }

  /// Within the little that grains fall.
  static void mobile(PinnedScene& scene) {
    spreading(scene);
    scene.spots.mobility = {0.3, 0.3, 2.0};
  }

  /// As strongly as spots may have it.
  static void exchanging_where_strained(PinnedScene& scene) {
    spreading(scene);
    scene.spots.full_strain = 0.8;
  }

  static void let_come_and_go(PinnedScene& scene) {
    const auto above = [](std::int64_t first, double z) {
      std::vector<spot::Grain> come;
      for (std::int64_t k = 0; k < 16; ++k)
        come.push_back({first + k, {-4.2 + 1.1 * static_cast<double>(k % 8), k < 8 ? -2.0 : 2.0, z}});
      return come;
    };
    Change mixed{0.8, {{400, 450, 500}, above(2000000, 14.0)}, nullptr};
    mixed.grains.come.push_back({450, {4.0, 3.0, 16.0}});              // moved
    mixed.grains.come.push_back({3000000, {-4.0, -3.0, 17.0}, true});  // held
    Change hole{1.0, {}, nullptr};                                     // those above it come down
    for (const spot::Grain& grain : scene.grains)
      if ((grain.position - spot::Vector3(3.0, 2.0, 3.0)).norm() < 1.5) hole.grains.gone.push_back(grain.id);
    scene.changes = {{0.4, {{}, above(1000000, 12.0)}, nullptr}, mixed, hole};
  }

  void add_to_both_drivers(bool time_ordered) {
    const auto scene = [&](const char* name, const std::function<void(PinnedScene&)>& alter) {
      add(time_ordered, name, alter);
    };
    scene("plain", [](PinnedScene&) {});
    scene("parabolic", [](PinnedScene& s) { s.spots.profile = spot::InfluenceProfile::parabolic; });
    scene("fixed-volume", [](PinnedScene& s) { s.spots.fixed_volume = 77.0; });
    scene("parabolic-fixed-volume", [](PinnedScene& s) {
      s.spots.profile = spot::InfluenceProfile::parabolic;
      s.spots.fixed_volume = 30.0;
    });
    scene("persistence", [](PinnedScene& s) { s.spots.persistence = 0.6; });
    scene("dilation", [](PinnedScene& s) { s.spots.dilation = 0.03; });
    scene("together", [](PinnedScene& s) { s.spots.together = true; });
    scene("contact-overlap", [](PinnedScene& s) { s.relaxation.contact_overlap = 2e-3; });
    scene("closing", [](PinnedScene& s) {
      s.relaxation.contact_overlap = 2e-3;
      s.relaxation.closing_gap = 4e-3;
      s.relaxation.closing_share = 0.1;
    });
    scene("full-strength", [](PinnedScene& s) {
      s.relaxation.strength = spot::RelaxationStrength::full_each;
      s.relaxation.alpha = 0.5;
    });
    scene("held", [](PinnedScene& s) {
      Draws draws(7);
      for (spot::Grain& grain : s.grains) grain.held = draws.uniform(0.0, 1.0) < 0.05;
    });
    scene("small-unit-far-away", [](PinnedScene& s) {
      const double d = 0.003;
      const spot::Vector3 place(1000.0 * d, -300.0 * d, 50.0 * d);
      s.diameter = d;
      s.extent = 1100.0 * d;
      s.spots.radius *= d;
      s.spots.step_width *= d;
      s.spots.step_height *= d;
      s.spots.speed *= d;
      s.limits.outlet = place.z() - d;
      s.container = spot::box_silo(place.x() - half_width * d, place.x() + half_width * d, place.y() - half_depth * d,
                                   place.y() + half_depth * d, spot::Orifice{place, 4.0 * d}, {1.0 * d, 2.6 * d});
      for (spot::Grain& grain : s.grains) grain.position = place + d * grain.position;
    });
    scene("loose", [](PinnedScene& s) {
      s.grains = random_grains(500, {0.5 - half_width, 0.5 - half_depth, 0.5},
                               {half_width - 0.5, half_depth - 0.5, 10.0}, 1.0, 5);
    });
    scene("gap", [](PinnedScene& s) {
      s.spots.radius = 1.0;
      s.container = spot::box_silo(-6.0, 6.0, -1.109, 1.109, spot::Orifice{{2.0, 0.0, 0.0}, 1.0}, {0.5, 1.0});
      s.grains = dense_grains({-5.5, -0.609, 0.5}, {5.5, 0.609, 10.0}, 0.01, 4);
      s.spots.influence = 2e-2;
    });
    scene("other-walls", [](PinnedScene& s) {
      s.spots.dilation = 0.03;
      s.changes = {{0.6, {}, small_silo(half_width - 0.01, half_depth + 0.2)}};
    });
    scene("come-and-go", let_come_and_go);
    scene("moves-received", [](PinnedScene& s) { s.counts_moves = true; });
    scene("all", all_at_once);
    scene("cylinder", into_cylinder);
    scene("cylinder-all", [](PinnedScene& s) {
      into_cylinder(s);
      all_at_once(s);
    });
    scene("all-come-and-go", [](PinnedScene& s) {
      all_at_once(s);
      let_come_and_go(s);
    });
  }

  void add_windowed() {
    const auto scene = [&](const char* name, const std::function<void(PinnedScene&)>& alter) {
      add(false, name, alter);
    };
    scene("momentum", [](PinnedScene& s) { s.relaxation.momentum = 0.8; });
    scene("exact", [](PinnedScene& s) { s.relaxation.tolerance = 5e-4; });
    // Lists are made anew within a window.
    scene("long-windows", [](PinnedScene& s) {
      s.window = 0.2;
      s.spots.influence = 0.03;
    });
  }

  /// The schedules of relaxation that 2010 compares.
  void add_time_ordered() {
    const auto scene = [&](const char* name, spot::RelaxationSchedule schedule, int every) {
      add(true, name, [schedule, every](PinnedScene& s) {
        s.relaxation.schedule = schedule;
        s.relaxation.every = every;
      });
    };
    scene("every-third-move", spot::RelaxationSchedule::moves, 3);
    scene("every-third-move-by-chance", spot::RelaxationSchedule::chance, 3);
    scene("every-third-move-of-each-spot", spot::RelaxationSchedule::spot, 3);
    scene("everywhere-now-and-then", spot::RelaxationSchedule::global, 1);
    scene("no-relaxation", spot::RelaxationSchedule::moves, 0);
  }

  std::vector<NamedScene> all_;
};

}  // namespace scenes
