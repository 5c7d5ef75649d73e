// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <string>

#include "spot/geometry/container.hpp"
#include "spot/geometry/outlets.hpp"
#include "spot/geometry/spot_buffers.hpp"

namespace spotcore {

/// What holds the grains, before it is known where the outlets are.
struct Walls {
  using Make = std::function<std::shared_ptr<const spot::Container>(const spot::Outlets&, const spot::SpotBuffers&)>;

  std::string text;
  Make make;
  double extent;  ///< no finite coordinate of them is larger, without its sign (length)
};

void bind_walls(pybind11::module_& module);

}  // namespace spotcore
