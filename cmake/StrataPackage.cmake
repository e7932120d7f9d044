# `cpack -G DEB` in the build folder makes two Debian packages: strata (the program with sample
# compositions and scenarios) and strata-dev (libraries, headers, find_package). docs/packaging.md.
if(STRATA_COMPONENTS)
  install(DIRECTORY components/config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/strata/compositions
    COMPONENT program FILES_MATCHING PATTERN "*.yaml")
  install(DIRECTORY tools/simulate/scenarios/ DESTINATION ${CMAKE_INSTALL_DATADIR}/strata/scenarios
    COMPONENT program FILES_MATCHING PATTERN "*.yaml")
  # Our messages, as `strata messages` writes them.
  install(DIRECTORY ${CMAKE_BINARY_DIR}/strata_msgs DESTINATION ${CMAKE_INSTALL_DATADIR}/strata
    COMPONENT program)
  install(FILES README.md CHANGELOG.md packaging/strata.service packaging/udp_only.xml
    packaging/grafana_dashboard.json packaging/prometheus.yml
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/strata COMPONENT program)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/strata RENAME copyright
    COMPONENT program)
endif()
# So that ROS 2's tools find the package in a colcon workspace.
install(FILES package.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/strata)
file(WRITE ${CMAKE_BINARY_DIR}/ament_marker/strata "")
install(FILES ${CMAKE_BINARY_DIR}/ament_marker/strata
  DESTINATION ${CMAKE_INSTALL_DATADIR}/ament_index/resource_index/packages)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME strata)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_CONTACT "Strata maintainers <maintainers@strata.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL development)
if(STRATA_COMPONENTS)
  list(PREPEND CPACK_COMPONENTS_ALL program)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME strata)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
# Run, not linked: shlibdeps cannot see them.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "librsvg2-bin, fonts-dejavu-core")
if(STRATA_FLEET)  # loaded when `strata fleet` needs it
  string(APPEND CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS ", libpq5")
endif()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME strata-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# What the installed package looks for with find_package; its libraries are static.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libceres-dev, libhwy-dev, liboctomap-dev, libsqlite3-dev, libzstd-dev")
if(STRATA_COMPONENTS)
  string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    ", libfastrtps-dev, libfastcdr-dev, libyaml-cpp-dev, liblz4-dev, libbz2-dev, zlib1g-dev, libpng-dev,"
    " librsvg2-bin, libssl-dev, nlohmann-json3-dev, libcli11-dev, libboost-dev")
  if(STRATA_FLEET)
    string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libpq5")
  endif()
endif()
include(CPack)
