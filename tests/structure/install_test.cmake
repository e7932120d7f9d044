# cmake -DBINARY_DIR=.. -DSOURCE_DIR=.. -DWITH_COMPONENTS=ON|OFF -P install_test.cmake
# Installs the build to a fresh prefix, then builds and runs a program outside the tree with it.
string(RANDOM LENGTH 8 suffix)
set(work ${BINARY_DIR}/install-test-${suffix})
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(STATUS "left in ${work}")
    message(FATAL_ERROR "failed (${result}): ${ARGV}\n${output}")
  endif()
endfunction()
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -E copy_directory ${SOURCE_DIR}/consumer ${work}/source)
run(${CMAKE_COMMAND} -G Ninja -S ${work}/source -B ${work}/build -DWITH_COMPONENTS=${WITH_COMPONENTS}
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
  -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/consumer)
if(WITH_COMPONENTS)
  run(${work}/build/component_consumer)
endif()
file(REMOVE_RECURSE ${work})
