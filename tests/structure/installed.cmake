# What tests of the installed tree share: ${prefix}, which the fixture `installed` made.
include(${CMAKE_CURRENT_LIST_DIR}/script.cmake)
set(prefix ${BINARY_DIR}/install-test/prefix)
set(headers ${prefix}/include)
# A checkout elsewhere finds what this one compiled.
set(ENV{CCACHE_BASEDIR} ${BINARY_DIR})
set(ENV{CCACHE_NOHASHDIR} 1)
# configure(FOLDER BUILD ...): a project outside the tree, with the installed package.
function(configure folder build)
  run(${CMAKE_COMMAND} -G Ninja -S ${folder} -B ${build} -DCMAKE_BUILD_TYPE=Debug
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
    -DCMAKE_CXX_FLAGS=${FLAGS} ${ARGN})
endfunction()
