// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace scenes {

/// The parameter of a test, made when it is asked for: every test of the program would wait for all of them.
template <typename Scene>
struct Named {
  std::string name;
  std::function<Scene()> make;

  friend void PrintTo(const Named& scene, std::ostream* out) { *out << scene.name; }
};

}  // namespace scenes
