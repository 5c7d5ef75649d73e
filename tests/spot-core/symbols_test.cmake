# SPDX-License-Identifier: GPL-2.0-or-later
# Fails if `library` asks for any of the C library's functions that are not exact; `user` must be found to do so.
set(functions "exp|exp2|exp10|expm1|log|log2|log10|log1p|pow|cbrt|hypot|sin|cos|sincos|tan|asin|acos|atan|atan2"
  "sinh|cosh|tanh|asinh|acosh|atanh|erf|erfc|tgamma|lgamma")
list(JOIN functions "|" functions)

function(find_inexact file found)
  execute_process(COMMAND ${nm} -u ${file} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  # Also as single, long double, with a version, or as what -ffinite-math asks for.
  string(REGEX MATCHALL " U (__)?(${functions})[fl]?(_finite)?(@[^\n]*)?\n" inexact "${symbols}")
  string(REGEX REPLACE "\n| U " "" inexact "${inexact}")
  set(${found} "${inexact}" PARENT_SCOPE)
endfunction()

find_inexact(${user} used_by_tests)
if(NOT used_by_tests)
  message(FATAL_ERROR "nothing was found in ${user}, which uses std::exp and more")
endif()
find_inexact(${library} used)
if(used)
  message(FATAL_ERROR "${library} asks the C library for ${used}, whose bits differ: use spot/elementary.hpp")
endif()
message(STATUS "none; the tests use ${used_by_tests}")
