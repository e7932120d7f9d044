# cmake -DSOURCE_DIR=.. -DVERSION=1.2.3 -P manifest_test.cmake
file(READ ${SOURCE_DIR}/package.xml manifest)
foreach(text "<version>${VERSION}</version>" "<build_type>cmake</build_type>" "<name>strata</name>")
  string(FIND "${manifest}" "${text}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "package.xml does not say ${text}")
  endif()
endforeach()
# Libraries of components are held against it.
file(READ ${SOURCE_DIR}/components/runtime/component_library.hpp library)
string(FIND "${library}" "\"strata ${VERSION}, " at)
if(at EQUAL -1)
  message(FATAL_ERROR "components/runtime/component_library.hpp does not say strata ${VERSION}")
endif()
