# SPDX-License-Identifier: GPL-2.0-or-later
# Installs spot-core into a prefix of its own, builds a project that finds it there, and runs what it built.
file(REMOVE_RECURSE ${scratch})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${build} --prefix ${scratch}/prefix COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${consumer} -B ${scratch}/consumer -G ${generator}
  -DCMAKE_CXX_COMPILER=${compiler} -DCMAKE_PREFIX_PATH=${scratch}/prefix COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${scratch}/consumer COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${scratch}/consumer/consumer COMMAND_ERROR_IS_FATAL ANY)
