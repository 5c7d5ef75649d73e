# SPDX-License-Identifier: GPL-2.0-or-later
# SPOT_PYTHON: an interpreter that can import what analysis and tests need. The first python3 on the PATH
# is often not the one for which Debian's packages are installed.
foreach(candidate python3 /usr/bin/python3)
  execute_process(COMMAND ${candidate} -c "import numpy, scipy, matplotlib, pytest"
    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(NOT failed)
    set(SPOT_PYTHON ${candidate} CACHE STRING "Python with numpy, scipy, matplotlib and pytest")
    break()
  endif()
endforeach()
if(NOT SPOT_PYTHON)
  message(WARNING "No Python with numpy, scipy, matplotlib and pytest: tests of analysis, lmp and liggghts are left out "
    "(Debian: python3-numpy python3-scipy python3-matplotlib python3-pytest)")
endif()
