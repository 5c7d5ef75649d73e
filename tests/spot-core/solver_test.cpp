// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/solver.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "packing/kernel_builds.hpp"
#include "scenes.hpp"
#include "spot/relaxation/cell_relaxation.hpp"

namespace {

using spot::CellRelaxation;
using spot::Grain;
using spot::RelaxationParameters;
using spot::TiledPacking;

std::vector<Grain> relaxed(std::unique_ptr<spot::Solver> solver, const RelaxationParameters& parameters, int sweeps) {
  const auto silo = scenes::small_silo(6.0, 4.0);
  TiledPacking packing(1.0, 100.0, -1.0, scenes::dense_grains({-5.5, -3.5, 0.5}, {5.5, 3.5, 8.0}, 0.08, 7), *silo);
  CellRelaxation relaxation(packing, parameters, std::move(solver));
  spot::Workers workers(2);
  for (int sweep = 0; sweep < sweeps; ++sweep) relaxation.sweep(0, 1.0, *silo, workers);
  std::vector<Grain> grains;
  packing.visit_grains([&](const Grain& grain) { grains.push_back(grain); });
  std::sort(grains.begin(), grains.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return grains;
}

/// Two ways to the same: the plain loop of the one, the kernel of the other.
TEST(SolverBruteForce, TheHeavyBallWithoutMomentumIsJacobi) {
  const auto& kernels = spot::kernels::best();
  scenes::expect_identical(relaxed(std::make_unique<spot::Jacobi>(), {}, 20),
                           relaxed(std::make_unique<spot::HeavyBall>(0.0, kernels), {}, 20));
  EXPECT_FALSE(relaxed(nullptr, {}, 20) == relaxed(nullptr, {}, 0)) << "grains overlap at first";
}

TEST(SolverUnit, ParametersChooseTheSolver) {
  const auto& kernels = spot::kernels::best();
  RelaxationParameters parameters;
  scenes::expect_identical(relaxed(nullptr, parameters, 5), relaxed(std::make_unique<spot::Jacobi>(), parameters, 5));
  parameters.momentum = 0.6;
  const auto chosen = relaxed(nullptr, parameters, 5);
  scenes::expect_identical(chosen, relaxed(std::make_unique<spot::HeavyBall>(0.6, kernels), parameters, 5));
  EXPECT_FALSE(chosen == relaxed(std::make_unique<spot::Jacobi>(), parameters, 5));
}

}  // namespace
