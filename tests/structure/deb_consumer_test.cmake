# cmake -DBINARY_DIR=.. -DSOURCE_DIR=.. -DLAUNCHER=.. -P deb_consumer_test.cmake
# A program outside the tree, built with the package strata-dev that deb_test.cmake unpacked.
include(${CMAKE_CURRENT_LIST_DIR}/deb_common.cmake)
file(REMOVE_RECURSE ${deb}/consumer ${deb}/consumer-build)
run(${CMAKE_COMMAND} -E copy_directory ${SOURCE_DIR}/consumer consumer)
run(${CMAKE_COMMAND} -G Ninja -S consumer -B consumer-build -DWITH_COMPONENTS=ON
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH=${deb}/root-dev/usr
  -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
file(STRINGS ${deb}/consumer-build/CMakeCache.txt found REGEX "^strata_DIR:")
expect("${found}" "=${deb}/root-dev/usr/")
run(${CMAKE_COMMAND} --build consumer-build)
run(${deb}/consumer-build/consumer)
run(${deb}/consumer-build/component_consumer)
