// SPDX-License-Identifier: GPL-2.0-or-later
// A line a profile: its name, mean share, and R_s over that of a uniform spot with the same volume. The analysis has
// the last in a table of its own, which its tests hold against this.
#include <cstdio>

#include "spot/walk/influence_profile.hpp"

int main() {
  for (const spot::InfluenceProfile* profile : spot::InfluenceProfile::all())
    std::printf("%s %.17g %.17g\n", profile->name(), profile->mean_share(), 1.0 / profile->equivalent_radius(1.0));
}
