# cmake -DBINARY_DIR=.. -DSOURCE_DIR=.. -DLAUNCHER=.. -DBUILD_TYPE=.. -P colcon_test.cmake
# Builds a workspace of two packages as its user does: strata, and one that depends on it. core and
# memory only, since the rest takes long and is built by the same lists. The sources are copied, so
# that paths are those of any checkout and ccache (LAUNCHER) has every object; without it nothing is
# optimized.
include(${CMAKE_CURRENT_LIST_DIR}/script.cmake)
find_program(colcon colcon)
if(NOT colcon)
  skip("colcon is not installed")
  return()
endif()
string(RANDOM LENGTH 8 suffix)
set(work ${BINARY_DIR}/colcon-test-${suffix})
set(consumer ${work}/src/consumer)
set(strata ${work}/src/strata)
set(flags -DCMAKE_BUILD_TYPE=${BUILD_TYPE})
if(NOT LAUNCHER)
  set(flags -DCMAKE_CXX_FLAGS_RELEASE=-O0)
endif()

file(COPY ${SOURCE_DIR}/ DESTINATION ${strata}
  PATTERN .git EXCLUDE PATTERN build EXCLUDE PATTERN docs EXCLUDE)
run(${CMAKE_COMMAND} -E copy_directory ${SOURCE_DIR}/tests/structure/consumer ${consumer})
set(places --base-paths ${strata} ${consumer})
run(${colcon} list --topological-order ${places})
string(REGEX REPLACE "[ \t]+" " " output "${output}")
if(NOT output MATCHES "^strata [^\n]* \\(ros.cmake\\)\nconsumer [^\n]* \\(ros.cmake\\)\n$")
  message(FATAL_ERROR "colcon does not see two CMake packages, strata first:\n${output}")
endif()
run(${colcon} build ${places} --build-base ${strata}/build --event-handlers console_direct+
  --cmake-args -GNinja -DSTRATA_COMPONENTS=OFF -DSTRATA_TESTS=OFF -DSTRATA_BENCH=OFF -DWITH_COMPONENTS=OFF
  ${flags})
foreach(file share/ament_index/resource_index/packages/strata share/strata/package.xml)
  if(NOT EXISTS ${work}/install/strata/${file})
    message(FATAL_ERROR "colcon's install folder lacks ${file}")
  endif()
endforeach()
run(${work}/install/consumer/lib/consumer/consumer)
file(REMOVE_RECURSE ${work})
