# cmake -DBINARY_DIR=.. -P deb_program_test.cmake
# Runs what deb_test.cmake unpacked.
include(${CMAKE_CURRENT_LIST_DIR}/deb_common.cmake)
try_program(${deb}/root)
