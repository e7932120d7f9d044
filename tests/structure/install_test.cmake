# cmake -DBINARY_DIR=.. -DSOURCE_DIR=.. -DWITH_COMPONENTS=ON|OFF -P install_test.cmake
# Builds and runs programs outside the tree with the installed package.
include(${CMAKE_CURRENT_LIST_DIR}/installed.cmake)
set(work ${BINARY_DIR}/install-test/programs)
file(REMOVE_RECURSE ${work})
# Builds a copy of examples/NAME with the installed package; ARGN: for CMake.
function(build_example name)
  run(${CMAKE_COMMAND} -E copy_directory ${EXAMPLES_DIR}/${name} ${work}/${name})
  configure(${work}/${name} ${work}/${name}/build ${ARGN})
  run(${CMAKE_COMMAND} --build ${work}/${name}/build)
endfunction()
# The mean distance from the poses of `truth` is below 0.1 m. kind: absolute or aligned.
function(expect_near kind poses truth)
  run(${prefix}/bin/strata evaluate ${poses} --truth ${truth} --json --quiet)
  string(JSON matched GET "${output}" ${kind} matched)
  string(JSON mean_m GET "${output}" ${kind} error_m mean)
  if(NOT matched GREATER 400 OR NOT mean_m LESS 0.1)
    message(FATAL_ERROR "${matched} poses of ${poses} are ${mean_m} m from ${truth}")
  endif()
endfunction()
run(${CMAKE_COMMAND} -E copy_directory ${SOURCE_DIR}/consumer ${work}/source)
configure(${work}/source ${work}/build -DWITH_COMPONENTS=${WITH_COMPONENTS})
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/consumer)
if(WITH_COMPONENTS)
  run(${work}/build/component_consumer)
  run(${prefix}/bin/strata messages ${work}/strata_msgs --quiet)
  run(diff -r ${work}/strata_msgs ${prefix}/share/strata/strata_msgs)

  # A component library, loaded by the installed program.
  build_example(obstacle_alarm)
  # Three beams a scan; 0.5 m is the example's one alarm below 0.8 m.
  file(WRITE ${work}/log.clf "FLASER 3 1 2 3 0 0 0 0 0 0 1.0 h 1.0
FLASER 3 1 0.5 3 0 0 0 0 0 0 1.2 h 1.2
FLASER 3 1 2 3 0 0 0 0 0 0 1.4 h 1.4
")
  set(ENV{STRATA_LIBRARY_PATH} ${work}/obstacle_alarm/build)
  set(composition ${work}/obstacle_alarm/composition.yaml)
  run(${prefix}/bin/strata run --check ${composition})
  expect("${output}" "/alarm +std_msgs/msg/String")
  if(NOT output MATCHES "example::ObstacleAlarm" OR NOT output MATCHES "libobstacle_alarm.so")
    message(FATAL_ERROR "run --check does not explain the component of the library:\n${output}")
  endif()
  run(${prefix}/bin/strata replay ${work}/log.clf --composition ${composition}
    --out ${work}/maps --quiet)
  file(READ ${work}/maps/obstacle_alarm.json alarms)
  if(NOT alarms STREQUAL "{\"scans\": 3, \"alarms\": 1}\n")
    message(FATAL_ERROR "the component of the library wrote ${alarms}")
  endif()

  # A message of one's own, by what the page says: its IDL, the command and its ROS 2 name.
  file(READ ${EXAMPLES_DIR}/../docs/own-components.md page)
  string(REGEX MATCH "`(module my_msgs [^`]*)`" found "${page}")
  file(WRITE ${work}/own/my_msgs.idl "${CMAKE_MATCH_1}\n")
  string(REGEX MATCH "```sh\n(mkdir[^`]*)```" found "${page}")
  file(WRITE ${work}/own/generate.sh "cd ${work}/own\n${CMAKE_MATCH_1}")
  string(REGEX MATCH "```cpp\n(template[^`]*)```" found "${page}")
  file(WRITE ${work}/own/scale.cpp "#include <functional>
#include <strata/runtime/component_library.hpp>
#include \"generated/my_msgs.h\"
${CMAKE_MATCH_1}
class Scale final : public strata::runtime::Component {
  using Component::Component;
  void on_configure() override { publish_ = advertise<my_msgs::msg::Load>(\"load\", \"default\"); }
  std::function<void(const my_msgs::msg::Load&)> publish_;
};
STRATA_COMPONENT_LIBRARY(registry) { registry.add<Scale>(\"own::Scale\"); }
")
  file(WRITE ${work}/own/CMakeLists.txt "cmake_minimum_required(VERSION 3.23)
project(scale LANGUAGES CXX)
find_package(strata REQUIRED COMPONENTS components)
strata_component_library(scale SOURCES scale.cpp generated/my_msgs.cxx)
")
  file(WRITE ${work}/own/composition.yaml "version: 1
transport: loopback
libraries: [build/libscale.so]
processes: [{name: main, components: [{type: own::Scale, name: scale}]}]
")
  run(bash ${work}/own/generate.sh)
  configure(${work}/own ${work}/own/build)
  run(${CMAKE_COMMAND} --build ${work}/own/build)
  run(${prefix}/bin/strata run --check ${work}/own/composition.yaml)
  expect("${output}" "/load +my_msgs/msg/Load")

  # Programs that call the library, with the packages of their rooms only.
  build_example(learn_from_scans -DCMAKE_DISABLE_FIND_PACKAGE_fastrtps=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_octomap=ON)
  build_example(localize_in_a_map -DCMAKE_DISABLE_FIND_PACKAGE_fastrtps=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_octomap=ON -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON)
  run(${prefix}/bin/strata simulate ${prefix}/share/strata/scenarios/office.yaml
    --per-day --out ${work}/drive --quiet)
  set(day ${work}/drive/day_1)
  run(${work}/learn_from_scans/build/learn_from_scans ${day}/log.clf ${work}/map.yaml)
  file(WRITE ${work}/learned.tum "${output}")
  expect_near(aligned ${work}/learned.tum ${day}/truth.tum)
  set(localize ${work}/localize_in_a_map/build/localize_in_a_map)
  run(${localize} ${work}/map.yaml ${day}/log.clf 0 0 0)
  file(WRITE ${work}/localized.tum "${output}")
  expect_near(absolute ${work}/localized.tum ${work}/learned.tum)
  execute_process(COMMAND ${localize} ${work}/map.yaml ${day}/log.clf 0 0 nan
    RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE errors)
  if(NOT result EQUAL 2)
    message(FATAL_ERROR "a start at nan ends with ${result}")
  endif()
  expect("${errors}" "^localize_in_a_map: error: start pose: [^\n]*\n$")

  # A room that is none.
  file(WRITE ${work}/no_room/CMakeLists.txt "cmake_minimum_required(VERSION 3.23)
project(no_room LANGUAGES CXX)
find_package(strata REQUIRED COMPONENTS core_slam cellar)
")
  execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${work}/no_room -B ${work}/no_room/build
    -DCMAKE_PREFIX_PATH=${prefix} RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE errors)
  if(result EQUAL 0)
    message(FATAL_ERROR "find_package finds a room that is none")
  endif()
  expect("${errors}" "no component and no room 'cellar'")
endif()
file(REMOVE_RECURSE ${work})
