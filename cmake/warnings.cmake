# SPDX-License-Identifier: GPL-2.0-or-later
# Warnings for this project's own targets; headers of libraries are included as SYSTEM.
function(spot_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
    $<$<BOOL:${SPOT_WARNINGS_AS_ERRORS}>:-Werror>)
endfunction()
