# cmake -DBINARY_DIR=.. -DSOURCE_DIR=.. [-DBUILD_BASE=..] -P colcon_test.cmake
# Builds a workspace of two packages as its user does: strata, and one that depends on it. core and
# memory only and not optimized, since the rest takes long and is built by the same lists.
include(${CMAKE_CURRENT_LIST_DIR}/script.cmake)
find_program(colcon colcon)
if(NOT colcon)
  skip("colcon is not installed")
  return()
endif()
string(RANDOM LENGTH 8 suffix)
set(work ${BINARY_DIR}/colcon-test-${suffix})
set(consumer ${work}/src/consumer)
if(NOT DEFINED BUILD_BASE)
  set(BUILD_BASE ${work}/build)
endif()

file(MAKE_DIRECTORY ${work})
run(${CMAKE_COMMAND} -E copy_directory ${SOURCE_DIR}/tests/structure/consumer ${consumer})
set(places --base-paths ${SOURCE_DIR} ${consumer})
run(${colcon} list --topological-order ${places})
string(REGEX REPLACE "[ \t]+" " " output "${output}")
if(NOT output MATCHES "^strata [^\n]* \\(ros.cmake\\)\nconsumer [^\n]* \\(ros.cmake\\)\n$")
  message(FATAL_ERROR "colcon does not see two CMake packages, strata first:\n${output}")
endif()
run(${colcon} build ${places} --build-base ${BUILD_BASE} --event-handlers console_direct+
  --cmake-args -GNinja -DSTRATA_COMPONENTS=OFF -DSTRATA_TESTS=OFF -DSTRATA_BENCH=OFF -DWITH_COMPONENTS=OFF
  -DCMAKE_CXX_FLAGS_RELEASE=-O0)
foreach(file share/ament_index/resource_index/packages/strata share/strata/package.xml)
  if(NOT EXISTS ${work}/install/strata/${file})
    message(FATAL_ERROR "colcon's install folder lacks ${file}")
  endif()
endforeach()
run(${work}/install/consumer/lib/consumer/consumer)
file(REMOVE_RECURSE ${work})
