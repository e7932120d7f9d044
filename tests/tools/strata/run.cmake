# SPDX-License-Identifier: Apache-2.0
# run(COMMAND ...): prints what it says; the script ends where it fails.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  message("${out}")
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}: exit code ${code}")
  endif()
endfunction()
