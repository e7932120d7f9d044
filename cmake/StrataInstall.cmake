# cmake --install: libraries, headers and a package for find_package(strata COMPONENTS core memory
# components) with the targets strata::core, strata::memory, strata::components and one target a
# room (strata::core_grid, ...). Rooms can be named too, COMPONENTS core_slam log: then only the
# packages that those and the rooms below them link are looked for.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/strata)

# The find_package name of an imported target.
function(strata_package_of target out)
  set(names Eigen3::Eigen=Eigen3 Threads::Threads=Threads Ceres::ceres=Ceres yaml-cpp=yaml-cpp
    SQLite::SQLite3=SQLite3 zstd::libzstd_shared=zstd ZLIB::ZLIB=ZLIB BZip2::BZip2=BZip2 PNG::PNG=PNG Boost::headers=Boost
    nlohmann_json::nlohmann_json=nlohmann_json CLI11::CLI11=CLI11
    fastcdr=fastcdr fastrtps=fastrtps hwy::hwy=HWY octomap=octomap OpenSSL::Crypto=OpenSSL OpenSSL::SSL=OpenSSL)
  foreach(pair ${names})
    if(pair MATCHES "^(.+)=(.+)$" AND CMAKE_MATCH_1 STREQUAL target)
      set(${out} ${CMAKE_MATCH_2} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  message(WARNING "cmake/StrataInstall.cmake: say which package defines ${target}")
  set(${out} "" PARENT_SCOPE)
endfunction()

# Two lines for strata-rooms.cmake: the rooms that a target links, and every package outside the
# project that it links, public or private: all are static.
function(strata_links_of target name out)
  set(rooms "")
  set(packages "")
  get_target_property(links ${target} INTERFACE_LINK_LIBRARIES)
  foreach(link ${links})
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" link "${link}")
    if(link MATCHES "^strata_(.+)$")
      list(APPEND rooms ${CMAKE_MATCH_1})
    elseif(link AND NOT link MATCHES "^/|^\\$<BUILD_INTERFACE|^\\$<LINK_ONLY:>$|^-|^[a-z0-9]+$"
           OR link MATCHES "^(fastcdr|fastrtps|octomap)$")
      strata_package_of(${link} package)
      list(APPEND packages ${package})
    endif()
  endforeach()
  list(REMOVE_ITEM rooms flags warnings)
  list(REMOVE_DUPLICATES packages)
  set(${out} "set(strata_${name}_rooms \"${rooms}\")\nset(strata_${name}_packages \"${packages}\")\n"
    PARENT_SCOPE)
endfunction()

get_property(all_rooms GLOBAL PROPERTY STRATA_ROOMS)
set(core_rooms ${all_rooms})
list(FILTER core_rooms INCLUDE REGEX "^strata_core_")
set(memory_rooms ${all_rooms})
list(FILTER memory_rooms INCLUDE REGEX "^strata_memory_")
set(components_rooms ${all_rooms})
list(FILTER components_rooms EXCLUDE REGEX "^strata_(core|memory|tools)_")

set_target_properties(strata_flags PROPERTIES EXPORT_NAME flags)
install(TARGETS strata_flags EXPORT strata_core)
set(installed_components "")
set(room_links "")
foreach(component core memory components)
  if(NOT ${component}_rooms)
    continue()
  endif()
  list(APPEND installed_components ${component})
  add_library(strata_${component} INTERFACE)
  add_library(strata::${component} ALIAS strata_${component})
  set_target_properties(strata_${component} PROPERTIES EXPORT_NAME ${component})
  target_link_libraries(strata_${component} INTERFACE ${${component}_rooms})
  install(TARGETS strata_${component} ${${component}_rooms} EXPORT strata_${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT strata_${component} NAMESPACE strata:: FILE strata-${component}.cmake
    DESTINATION ${package_dir})
  foreach(target strata_${component} ${${component}_rooms})
    string(REGEX REPLACE "^strata_" "" name ${target})
    strata_links_of(${target} ${name} lines)
    string(APPEND room_links "${lines}")
  endforeach()
endforeach()
file(WRITE ${CMAKE_BINARY_DIR}/strata-rooms.cmake "${room_links}")
install(FILES ${CMAKE_BINARY_DIR}/strata-rooms.cmake DESTINATION ${package_dir})

# <strata/ROOM/NAME.hpp>: made by the build, as headers change without CMake (public_headers.cmake).
get_property(declared GLOBAL PROPERTY STRATA_PUBLIC_HEADERS)
set(headers_list ${CMAKE_BINARY_DIR}/public_headers.txt)
string(REPLACE ";" "\n" declared_lines "${declared}")
file(CONFIGURE OUTPUT ${headers_list} CONTENT "${declared_lines}\n")
file(GLOB_RECURSE all_headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}
  core/*.hpp memory/*.hpp components/*.hpp)
foreach(header ${declared})
  if(NOT header IN_LIST all_headers)
    message(FATAL_ERROR "PUBLIC_HEADERS: there is no ${header}")
  endif()
endforeach()
set(headers_made ${CMAKE_BINARY_DIR}/public_headers)
set(headers_script ${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake)
add_custom_command(OUTPUT ${headers_made}.stamp
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DDECLARED=${headers_list}
    -DOUT=${headers_made} -P ${headers_script}
  COMMAND ${CMAKE_COMMAND} -E touch ${headers_made}.stamp
  DEPENDS ${all_headers} ${headers_list} ${headers_script}
  COMMENT "Making the headers that are installed" VERBATIM)
add_custom_target(strata_public_headers ALL DEPENDS ${headers_made}.stamp)
install(DIRECTORY ${headers_made}/strata DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(STRATA_COMPONENTS)
  install(DIRECTORY ${CMAKE_BINARY_DIR}/idl/include/strata_idl/
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/strata/idl
    FILES_MATCHING PATTERN "*PubSubTypes.h" EXCLUDE PATTERN "*.h")
endif()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/strataConfig.cmake.in
  ${CMAKE_BINARY_DIR}/strataConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/strataConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/StrataComponentLibrary.cmake
  ${CMAKE_BINARY_DIR}/strataConfig.cmake ${CMAKE_BINARY_DIR}/strataConfigVersion.cmake
  DESTINATION ${package_dir})
