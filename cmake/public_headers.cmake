# cmake -DSOURCE=ROOT -DDECLARED=FILE -DOUT=FOLDER -P public_headers.cmake
# The headers that are installed: those that rooms declare (FILE, a path in ROOT a line) and what
# these include, each as OUT/strata/ROOM/NAME.hpp. In the tree a room lies in its group, as
# core/localization; outside there are rooms only, so the lines that include are rewritten:
#
#   #include "core/localization/localizer.hpp"  ->  #include <strata/localization/localizer.hpp>
#   #include "strata_idl/sensor_msgs.h"         ->  #include <strata/idl/sensor_msgs.h>
cmake_minimum_required(VERSION 3.22)
set(group "(core|memory|components)")

file(STRINGS ${DECLARED} open)
set(files "")
while(open)
  list(POP_FRONT open header)
  if(NOT header IN_LIST files)
    list(APPEND files ${header})
    file(STRINGS ${SOURCE}/${header} lines REGEX "^#include \"${group}/")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^#include \"([^\"]+)\".*$" "\\1" included "${line}")
      list(APPEND open ${included})
    endforeach()
  endif()
endwhile()
list(SORT files)

set(made "")
foreach(header IN LISTS files)
  string(REGEX REPLACE "^${group}/" "" name ${header})
  if(DEFINED source_of_${name})
    message(FATAL_ERROR "${header} and ${source_of_${name}} would both be <strata/${name}>")
  endif()
  set(source_of_${name} ${header})
  list(APPEND made ${OUT}/strata/${name})
  file(READ ${SOURCE}/${header} text)
  string(REGEX REPLACE "#include \"${group}/([^\"\n]+)\"" "#include <strata/\\2>" text "${text}")
  string(REGEX REPLACE "#include \"strata_idl/([^\"\n]+)\"" "#include <strata/idl/\\1>" text "${text}")
  set(before "")
  if(EXISTS ${OUT}/strata/${name})
    file(READ ${OUT}/strata/${name} before)
  endif()
  if(NOT text STREQUAL before)
    file(WRITE ${OUT}/strata/${name} "${text}")
  endif()
endforeach()

file(GLOB_RECURSE there ${OUT}/strata/*)
list(REMOVE_ITEM there ${made})
if(there)
  file(REMOVE ${there})
endif()
