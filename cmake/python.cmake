# SPDX-License-Identifier: GPL-2.0-or-later
# SPOT_PYTHON: an interpreter that can import what analysis and tests need.
if(NOT DEFINED SPOT_PYTHON)
  execute_process(COMMAND ${CMAKE_CURRENT_LIST_DIR}/../scripts/python.sh
    OUTPUT_VARIABLE found ERROR_VARIABLE reason OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_STRIP_TRAILING_WHITESPACE)
  set(SPOT_PYTHON "${found}" CACHE STRING "Python with numpy, scipy, matplotlib and pytest")
  if(NOT SPOT_PYTHON)
    message(WARNING "Tests of analysis, lmp and liggghts are left out: ${reason}")
  endif()
endif()
