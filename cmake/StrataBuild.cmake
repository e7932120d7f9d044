# Compiler settings that every target of ours shares.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

find_program(STRATA_CCACHE ccache)
if(STRATA_CCACHE)
  # What ccache asks for where headers are precompiled; and a checkout elsewhere finds what this
  # one compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${STRATA_CCACHE})
endif()

add_library(strata_flags INTERFACE)
add_library(strata::flags ALIAS strata_flags)
# -ffp-contract=off: a fused multiply-add rounds once instead of twice, and whether the compiler
# makes one depends on the target; runs must be the same bits on every machine.
target_compile_options(strata_flags INTERFACE -ffp-contract=off)
target_include_directories(strata_flags INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include>)
target_compile_features(strata_flags INTERFACE cxx_std_20)

add_library(strata_warnings INTERFACE)
target_compile_options(strata_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual
  -Wunused -Wdouble-promotion -Werror)
# g++ makes the products; what other compilers warn of is for reading.
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(strata_warnings INTERFACE -Wno-error)
endif()
# g++ 12 warns of overlap in "text" + std::string, wrongly (GCC bug 105651), and of its bounds where
# <string> is precompiled.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(strata_warnings INTERFACE
    -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()

# Warned of where a hidden type is a private member's: every file but the first looks as a header does.
if(STRATA_TOGETHER AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(strata_warnings INTERFACE -Wno-subobject-linkage)
endif()

if(STRATA_SANITIZE)
  add_compile_options(-fsanitize=${STRATA_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${STRATA_SANITIZE})
  # GCC warns wrongly where the sanitizers' checks keep it from seeing that a value is set.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(strata_warnings INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()

# The fuzzers' own main comes with -fsanitize=fuzzer at their link (tests/fuzz).
if(STRATA_FUZZ)
  set(fuzz_flags -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined)
  add_compile_options(${fuzz_flags} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
