// SPDX-License-Identifier: GPL-2.0-or-later
// The Python module: one file a concept. Here, what is common: the module itself, and errors.
#include <pybind11/pybind11.h>

#include <exception>

#include "drainage.hpp"
#include "outlets.hpp"
#include "packing.hpp"
#include "parameters.hpp"
#include "spot/base/errors.hpp"
#include "walls.hpp"

namespace py = pybind11;

namespace {

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const spot::CollapsedPacking&) {
    throw;  // has a class of its own
  } catch (const spot::Error& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  }
}

}  // namespace

PYBIND11_MODULE(_spotcore, module) {
  // What is defined here is known by the package's name.
  const py::object name = module.attr("__name__");
  module.attr("__name__") = "spotcore";
  module.attr("__version__") = SPOTCORE_VERSION;
  py::register_exception<spot::CollapsedPacking>(module, "CollapsedPacking", PyExc_RuntimeError).doc() =
      "Relaxation does not keep up with the spots: grains went too deep into each other, or through the base.";
  py::register_exception_translator(translate);
  spotcore::bind_packing(module);
  spotcore::bind_walls(module);
  spotcore::bind_outlets(module);
  spotcore::bind_parameters(module);
  spotcore::bind_drainage(module);
  module.attr("__name__") = name;
}
