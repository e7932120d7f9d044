# What test scripts share.
cmake_minimum_required(VERSION 3.22)
# run(COMMAND...): in the folder `work`, if that is set; `output` is what it says on standard output.
# When it fails, so does the test, with all that it said.
function(run)
  set(place "")
  if(work AND IS_DIRECTORY ${work})
    set(place WORKING_DIRECTORY ${work})
  endif()
  execute_process(COMMAND ${ARGV} ${place} RESULT_VARIABLE result
    OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT result EQUAL 0)
    message(STATUS "left in ${work}")
    message(FATAL_ERROR "failed (${result}): ${ARGV}\n${output}\n${errors}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
function(expect text pattern)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "no ${pattern} in\n${text}")
  endif()
endfunction()
# skip(REASON): what STRATA_SKIPPED in CMakeLists.txt looks for; return() after it.
function(skip reason)
  message(STATUS "this test is skipped: ${reason}")
endfunction()
