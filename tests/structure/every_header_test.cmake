# cmake -DBINARY_DIR=.. -DSOURCE_DIR=.. -P every_header_test.cmake
# Every installed header compiles alone, with what its room links; every room links alone.
include(${CMAKE_CURRENT_LIST_DIR}/installed.cmake)
set(build ${BINARY_DIR}/install-test/every_header)
# Nobody debugs them.
configure(${SOURCE_DIR}/every_header ${build} -DHEADERS=${headers} -DCMAKE_BUILD_TYPE=)
run(${CMAKE_COMMAND} --build ${build} --parallel 2)
