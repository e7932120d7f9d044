# cmake -DBINARY_DIR=.. -P installed_test.cmake
# Installs the build for the tests that use it.
include(${CMAKE_CURRENT_LIST_DIR}/installed.cmake)
file(REMOVE_RECURSE ${BINARY_DIR}/install-test)
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${prefix})
