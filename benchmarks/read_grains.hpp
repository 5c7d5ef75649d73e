// SPDX-License-Identifier: GPL-2.0-or-later
// The grains of a data file of LAMMPS, for benchmarks.
#pragma once

#include <array>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "spot/packing/packing.hpp"

/// From a file in metres, compressed or not; in grain diameters.
inline std::vector<spot::Grain> read_grains(const std::string& path) {
  constexpr double diameter_in_metres = 0.003;
  const std::string command = "gzip -dcf '" + path + "'";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::vector<spot::Grain> grains;
  std::array<char, 256> line;
  while (pipe && std::fgets(line.data(), line.size(), pipe.get())) {
    long long id;
    double x, y, z;
    if (std::sscanf(line.data(), "%lld %*d %*f %*f %lf %lf %lf", &id, &x, &y, &z) == 4)
      grains.push_back({id, spot::Vector3(x, y, z) / diameter_in_metres});
  }
  if (grains.empty()) throw std::runtime_error("no grains in " + path);
  return grains;
}
