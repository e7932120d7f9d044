# Several files of a target are compiled as one, for what they read is read once then: three times
# fewer seconds for tests, half as many for rooms. Two hidden names of neighbours that are equal do
# not compile, and none may be a header's (tools/check-hidden-names); clang-tidy reads every file for
# itself (tools/check-tidy). Not by CMAKE_UNITY_BUILD, whose files name the checkout: ccache would
# find in one nothing of another.
option(STRATA_TOGETHER "Compile several files of a target as one" ON)
set(STRATA_FILES_AT_ONCE 8)

# Whether a file cannot stand beside others: kernels, which Highway includes once for each SIMD
# target, what says so of itself (SKIP_UNITY_BUILD_INCLUSION), and what is generated.
function(strata_stands_alone source path out)
  cmake_path(IS_PREFIX PROJECT_BINARY_DIR ${path} alone)
  get_source_file_property(skipped ${source} SKIP_UNITY_BUILD_INCLUSION)
  set(kernel "")
  if(EXISTS ${path})
    file(STRINGS ${path} kernel REGEX "HWY_TARGET_INCLUDE" LIMIT_COUNT 1)
  else()
    set(alone YES)
  endif()
  if(skipped OR kernel OR NOT path MATCHES "[.]cpp$")
    set(alone YES)
  endif()
  set(${out} ${alone} PARENT_SCOPE)
endfunction()

# What to compile for these sources of a target.
function(strata_together out target)
  if(NOT STRATA_TOGETHER)
    set(${out} ${ARGN} PARENT_SCOPE)
    return()
  endif()
  set(compiled "")
  set(names "")
  foreach(source IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE
      OUTPUT_VARIABLE path)
    strata_stands_alone(${source} ${path} alone)
    if(alone)
      list(APPEND compiled ${source})
    else()
      cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
      list(APPEND names ${path})
    endif()
  endforeach()
  set(number 0)
  while(names)
    list(SUBLIST names 0 ${STRATA_FILES_AT_ONCE} some)
    list(REMOVE_ITEM names ${some})
    list(TRANSFORM some REPLACE "(.+)" "#include \"\\1\"\n")
    list(JOIN some "" text)
    set(file ${CMAKE_CURRENT_BINARY_DIR}/Unity/${target}_${number}.cpp)
    file(CONFIGURE OUTPUT ${file} CONTENT "${text}")
    list(APPEND compiled ${file})
    math(EXPR number "${number} + 1")
  endwhile()
  set(${out} ${compiled} PARENT_SCOPE)
endfunction()
