# cmake -DSOURCE_DIR=.. -DPROGRAM=the built strata -DINSTALLED=/usr/bin/strata -DWORK=.. -P service_test.cmake
# The sample unit is one that systemd takes, and runs what the Debian package installs.
include(${CMAKE_CURRENT_LIST_DIR}/script.cmake)
find_program(verifier systemd-analyze)
if(NOT verifier)
  skip("systemd-analyze is not installed")
  return()
endif()
file(READ ${SOURCE_DIR}/packaging/strata.service unit)
if(NOT unit MATCHES "\nExecStart=${INSTALLED} run ")
  message(FATAL_ERROR "the unit does not run ${INSTALLED}, which the package installs:\n${unit}")
endif()
if(NOT unit MATCHES "\nUser=[a-z]+\n" OR unit MATCHES "\nDynamicUser=yes")
  message(FATAL_ERROR "the unit does not run as the robot's user, whose shared memory it needs:\n${unit}")
endif()
# Killed by systemd before its own patience ends, `strata run` would lose what it has not written.
file(READ ${SOURCE_DIR}/tools/strata/process_group.hpp patience)
string(REGEX MATCH "kStopPatience{([0-9]+)}" _ "${patience}")
set(patience_s ${CMAKE_MATCH_1})
string(REGEX MATCH "\nTimeoutStopSec=([0-9]+)\n" _ "${unit}")
math(EXPR left_s "${CMAKE_MATCH_1} - ${patience_s}")
if(left_s LESS 3)
  message(FATAL_ERROR "TimeoutStopSec=${CMAKE_MATCH_1} leaves ${left_s} s to a `strata run` that takes up to ${patience_s} s to write")
endif()
# systemd looks whether the program is there: the built one stands for the installed one.
string(REPLACE "ExecStart=${INSTALLED} " "ExecStart=${PROGRAM} " unit "${unit}")
file(WRITE ${WORK}/strata.service "${unit}")
execute_process(COMMAND ${verifier} verify --man=no ${WORK}/strata.service
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
# A key that it does not know is a warning only.
if(NOT result EQUAL 0 OR NOT output STREQUAL "")
  message(FATAL_ERROR "systemd-analyze verify (${result}):\n${output}")
endif()
