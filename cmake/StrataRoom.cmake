# Kernels for machines without SIMD too, which newer Highways leave out on x86-64: the tests compare
# them with the others (tests/support/every_target.hpp). Not for fuzzing: clang takes minutes for
# each kernel on each of its targets with sanitizers in it.
function(strata_every_simd_target target)
  if("hwy::hwy" IN_LIST ARGN AND NOT STRATA_FUZZ)
    target_compile_definitions(${target} PRIVATE HWY_COMPILE_ALL_ATTAINABLE)
  endif()
endfunction()

# One room = one folder = one library target. A room links exactly what it may include.
#
#   strata_room(core_grid SOURCES a.cpp b.cpp LINKS core_base core_geometry PACKAGES Eigen3::Eigen
#               PRIVATE_PACKAGES Ceres::ceres PUBLIC_HEADERS a.hpp)
#
# LINKS names rooms; HEADERS_OF rooms whose types it takes without calling what lies in their
# libraries, so that a program is not linked with them either; PACKAGES are imported targets that its headers need; PRIVATE_PACKAGES only its
# .cpp files. PUBLIC_HEADERS are what users of the library include; they are installed with what
# they include themselves, nothing else is. A room without SOURCES is header-only.
function(strata_room name)
  cmake_parse_arguments(ROOM "" ""
    "SOURCES;LINKS;HEADERS_OF;PACKAGES;PRIVATE_PACKAGES;PUBLIC_HEADERS" ${ARGN})
  set(target strata_${name})
  list(TRANSFORM ROOM_LINKS PREPEND strata_)
  if(ROOM_SOURCES)
    strata_together(sources ${target} ${ROOM_SOURCES})
    add_library(${target} STATIC ${sources})
    target_link_libraries(${target} PUBLIC strata_flags ${ROOM_LINKS} ${ROOM_PACKAGES}
      PRIVATE $<BUILD_INTERFACE:strata_warnings> ${ROOM_PRIVATE_PACKAGES})
    strata_every_simd_target(${target} ${ROOM_PRIVATE_PACKAGES})
    strata_use_precompiled(${target} FOR_LIBRARY)
  else()
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE strata_flags ${ROOM_LINKS} ${ROOM_PACKAGES})
  endif()
  add_library(strata::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY STRATA_ROOMS ${target})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  list(TRANSFORM ROOM_PUBLIC_HEADERS PREPEND ${folder}/)
  set_property(GLOBAL APPEND PROPERTY STRATA_PUBLIC_HEADERS ${ROOM_PUBLIC_HEADERS})
endfunction()

# A room whose register.hpp has register_component(): compositions can name it, and tests and pages
# of all components have it (tools/all_components).
function(strata_component name)
  strata_room(${name} ${ARGN} PUBLIC_HEADERS register.hpp)
  set_property(GLOBAL APPEND PROPERTY STRATA_COMPONENT_ROOMS ${name})
endfunction()

# One test program a folder of tests: strata_tests(core_grid SOURCES ... LINKS core_grid). ALONE: no
# other test runs beside its own.
function(strata_tests name)
  cmake_parse_arguments(TESTS "ALONE" "TIMEOUT" "SOURCES;LINKS;PACKAGES;LABELS" ${ARGN})
  set(target test_${name})
  strata_together(sources ${target} ${TESTS_SOURCES})
  add_executable(${target} ${sources})
  list(TRANSFORM TESTS_LINKS PREPEND strata_)
  target_link_libraries(${target} PRIVATE ${TESTS_LINKS} ${TESTS_PACKAGES} strata_test_support
    strata_simd_target strata_warnings GTest::gmock GTest::gtest_main)
  strata_every_simd_target(${target} ${TESTS_PACKAGES})
  strata_use_precompiled(${target} FOR_TESTS)
  if(NOT TESTS_TIMEOUT)
    set(TESTS_TIMEOUT 300)
  endif()
  gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST
    PROPERTIES TIMEOUT ${TESTS_TIMEOUT} RUN_SERIAL ${TESTS_ALONE} LABELS "${TESTS_LABELS}")
endfunction()
