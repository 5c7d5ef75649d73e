# SPDX-License-Identifier: GPL-2.0-or-later
# Headers of others that nearly every file of a target includes, compiled once: Eigen alone takes two seconds a file.
# Files still include what they use; -D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON shows whether they do.
function(spot_precompile target)
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <cmath> <functional> <map> <memory> <optional> <string> <vector> <Eigen/Core> ${ARGN})
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)  # for ccache
endfunction()
