# cmake -DSOURCE_DIR=.. -P dependencies_test.cmake
cmake_minimum_required(VERSION 3.22)
# What CMake looks for, what package.xml tells rosdep and what tools/install-packages installs.

# find_package's name -> Debian package. System: comes with the compiler.
set(found_by
  Threads=System BZip2=libbz2-dev Boost=libboost-dev Ceres=libceres-dev CLI11=libcli11-dev Eigen3=libeigen3-dev GTest=libgtest-dev
  OpenSSL=libssl-dev PNG=libpng-dev PostgreSQL=libpq-dev Python3=python3 SQLite3=libsqlite3-dev
  ZLIB=zlib1g-dev benchmark=libbenchmark-dev fastcdr=libfastcdr-dev fastrtps=libfastrtps-dev
  hwy=libhwy-dev nlohmann_json=nlohmann-json3-dev octomap=liboctomap-dev
  yaml-cpp=libyaml-cpp-dev zstd=libzstd-dev)
# rosdep key -> Debian package, as rosdistro's rosdep/base.yaml and python.yaml had it in August 2026.
set(keys
  cmake=cmake eigen=libeigen3-dev libceres-dev=libceres-dev libboost-dev=libboost-dev
  liboctomap-dev=liboctomap-dev libssl-dev=libssl-dev libsqlite3-dev=libsqlite3-dev
  libzstd-dev=libzstd-dev liblz4-dev=liblz4-dev bzip2=libbz2-dev zlib=zlib1g-dev libpng-dev=libpng-dev libpq-dev=libpq-dev
  yaml-cpp=libyaml-cpp-dev nlohmann-json-dev=nlohmann-json3-dev
  cli11=libcli11-dev libgtest-dev=libgtest-dev libgmock-dev=libgmock-dev benchmark=libbenchmark-dev
  python3=python3)
# No key has them: package.xml says so, and docs/packaging.md gives the command.
set(without_key libfastrtps-dev libfastcdr-dev fastddsgen default-jre-headless cpp libhwy-dev librsvg2-bin fonts-dejavu-core)

function(look_up table name out)
  set(${out} "" PARENT_SCOPE)
  foreach(pair ${${table}})
    string(REGEX MATCH "^([^=]+)=(.+)$" pair "${pair}")
    if(CMAKE_MATCH_1 STREQUAL name)
      set(${out} ${CMAKE_MATCH_2} PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

file(READ ${SOURCE_DIR}/package.xml manifest)
file(READ ${SOURCE_DIR}/tools/install-packages installed)
file(READ ${SOURCE_DIR}/docs/packaging.md guide)
string(REGEX REPLACE "[ \n]+" " " installed " ${installed} ")
string(REGEX REPLACE "[ \n`]+" " " guide " ${guide} ")
string(REGEX MATCH "<!--.*-->" comment "${manifest}")
string(REGEX REPLACE "[ \n]+" " " comment "${comment}")

set(problems "")
set(declared "")
string(REGEX MATCHALL "<[a-z_]*depend>[^<]*</" entries "${manifest}")
foreach(entry ${entries})
  string(REGEX REPLACE "^<[a-z_]*depend>([^<]*)</$" "\\1" key "${entry}")
  look_up(keys "${key}" package)
  if(NOT package)
    list(APPEND problems "package.xml: '${key}' is no rosdep key that this test knows")
    continue()
  endif()
  list(APPEND declared ${package})
  if(NOT installed MATCHES " ${package} ")
    list(APPEND problems "tools/install-packages lacks ${package}, which package.xml names")
  endif()
endforeach()
foreach(package ${without_key})
  if(NOT comment MATCHES " ${package} ")
    list(APPEND problems "package.xml: the comment lacks ${package}, which has no rosdep key")
  endif()
  if(NOT guide MATCHES " ${package} ")
    list(APPEND problems "docs/packaging.md: the apt-get line lacks ${package}")
  endif()
endforeach()

# Lists of the build only: examples and consumers look for strata itself.
file(GLOB_RECURSE lists ${SOURCE_DIR}/core/CMakeLists.txt ${SOURCE_DIR}/memory/CMakeLists.txt
  ${SOURCE_DIR}/components/CMakeLists.txt ${SOURCE_DIR}/idl/CMakeLists.txt
  ${SOURCE_DIR}/tools/CMakeLists.txt ${SOURCE_DIR}/tests/CMakeLists.txt ${SOURCE_DIR}/cmake/*.cmake)
list(APPEND lists ${SOURCE_DIR}/CMakeLists.txt)
list(FILTER lists EXCLUDE REGEX "/(consumer|every_header)/")
set(names "")
foreach(file ${lists})
  file(READ ${file} text)
  string(REGEX MATCHALL "find_package\\([^)]*REQUIRED" calls "${text}")
  foreach(call ${calls})
    string(REGEX REPLACE "^find_package\\([ \n]*([A-Za-z0-9_-]+).*$" "\\1" name "${call}")
    list(APPEND names ${name})
  endforeach()
endforeach()
list(REMOVE_DUPLICATES names)
list(LENGTH names count)
if(count LESS 15)
  list(APPEND problems "only ${count} find_package(... REQUIRED) were found: does this test still read them?")
endif()
foreach(name ${names})
  look_up(found_by ${name} package)
  if(NOT package)
    list(APPEND problems "find_package(${name}): name its Debian package in this test and in package.xml")
  elseif(NOT package STREQUAL System AND NOT package IN_LIST declared
      AND NOT package IN_LIST without_key)
    list(APPEND problems "package.xml has no entry for ${package}, which find_package(${name}) needs")
  endif()
endforeach()
if(problems)
  list(JOIN problems "\n" problems)
  message(FATAL_ERROR "${problems}")
endif()
