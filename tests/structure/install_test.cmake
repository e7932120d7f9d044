# cmake -DBINARY_DIR=.. -DSOURCE_DIR=.. -DWITH_COMPONENTS=ON|OFF -P install_test.cmake
# Installs the build to a fresh prefix, then builds and runs a program outside the tree with it.
include(${CMAKE_CURRENT_LIST_DIR}/script.cmake)
string(RANDOM LENGTH 8 suffix)
set(work ${BINARY_DIR}/install-test-${suffix})
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -E copy_directory ${SOURCE_DIR}/consumer ${work}/source)
run(${CMAKE_COMMAND} -G Ninja -S ${work}/source -B ${work}/build -DWITH_COMPONENTS=${WITH_COMPONENTS}
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
  -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/consumer)
if(WITH_COMPONENTS)
  run(${work}/build/component_consumer)
  run(${work}/prefix/bin/strata messages ${work}/strata_msgs --quiet)
  run(diff -r ${work}/strata_msgs ${work}/prefix/share/strata/strata_msgs)

  # A component library, loaded by the installed program.
  run(${CMAKE_COMMAND} -E copy_directory ${EXAMPLES_DIR}/obstacle_alarm ${work}/obstacle_alarm)
  run(${CMAKE_COMMAND} -G Ninja -S ${work}/obstacle_alarm -B ${work}/obstacle_alarm/build
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH=${work}/prefix
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_CXX_FLAGS=${FLAGS})
  run(${CMAKE_COMMAND} --build ${work}/obstacle_alarm/build)
  # Three beams a scan; 0.5 m is the example's one alarm below 0.8 m.
  file(WRITE ${work}/log.clf "FLASER 3 1 2 3 0 0 0 0 0 0 1.0 h 1.0
FLASER 3 1 0.5 3 0 0 0 0 0 0 1.2 h 1.2
FLASER 3 1 2 3 0 0 0 0 0 0 1.4 h 1.4
")
  set(ENV{STRATA_LIBRARY_PATH} ${work}/obstacle_alarm/build)
  set(composition ${work}/obstacle_alarm/composition.yaml)
  run(${work}/prefix/bin/strata run --check ${composition})
  if(NOT output MATCHES "example::ObstacleAlarm" OR NOT output MATCHES "libobstacle_alarm.so")
    message(FATAL_ERROR "run --check does not explain the component of the library:\n${output}")
  endif()
  run(${work}/prefix/bin/strata replay ${work}/log.clf --composition ${composition}
    --out ${work}/maps --quiet)
  file(READ ${work}/maps/obstacle_alarm.json alarms)
  if(NOT alarms STREQUAL "{\"scans\": 3, \"alarms\": 1}\n")
    message(FATAL_ERROR "the component of the library wrote ${alarms}")
  endif()
endif()
file(REMOVE_RECURSE ${work})
