# strata_component_library(NAME SOURCES a.cpp b.cpp LINKS other_targets): a shared library whose
# components a composition loads by NAME. Only what STRATA_COMPONENT_LIBRARY makes is visible, so
# that its copy of anything never meets another library's.
function(strata_component_library name)
  cmake_parse_arguments(LIBRARY "" "" "SOURCES;LINKS" ${ARGN})
  add_library(${name} MODULE ${LIBRARY_SOURCES})
  target_link_libraries(${name} PRIVATE strata::runtime ${LIBRARY_LINKS})
  set_target_properties(${name} PROPERTIES CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  target_link_options(${name} PRIVATE LINKER:--exclude-libs,ALL)
endfunction()
