// SPDX-License-Identifier: Apache-2.0
/// Components of others: shared libraries that a composition names, loaded when it starts.
///
/// A library has this once, in one of its files, and is linked with strata::runtime (CMake:
/// strata_component_library(NAME SOURCES ...)):
///
///     STRATA_COMPONENT_LIBRARY(registry) {
///       registry.add<example::ObstacleAlarm>("example::ObstacleAlarm");
///     }
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/bus/text_message.hpp"
#include "components/runtime/composition.hpp"
#include "components/runtime/registry.hpp"

namespace strata::runtime {

/// Folders to look for libraries in, separated by colons.
inline constexpr const char* kLibraryPathVariable = "STRATA_LIBRARY_PATH";

/// What the program and a library must agree on before objects may pass between them: the version,
/// the layout of what is passed, and the standard library's own switches.
[[nodiscard]] inline std::string library_interface() {
  return "strata 0.1.0, component of " + std::to_string(sizeof(Component)) + " bytes, context of " +
         std::to_string(sizeof(ComponentContext)) + ", C++ ABI " +
         std::to_string(__GXX_ABI_VERSION) + "/" + std::to_string(_GLIBCXX_USE_CXX11_ABI);
}

/// Adds the components of every library that the composition names; returns their files as they
/// were found. "obstacle_alarm" is libobstacle_alarm.so, as is "libobstacle_alarm.so", in the
/// composition's folder, in those of STRATA_LIBRARY_PATH, or where the system's loader looks; a
/// name with a slash is a file, relative to the composition's folder. Libraries stay loaded until
/// the process ends, since DDS keeps types of theirs. Throws ConfigError at the library's line: it
/// is not found or does not load (with the loader's words), has no components, was built against
/// another Strata, or has a type that is there already.
std::vector<std::filesystem::path> load_component_libraries(const Composition& composition,
                                                            Registry& registry);

}  // namespace strata::runtime

#define STRATA_COMPONENT_LIBRARY(registry)                                                  \
  extern "C" __attribute__((visibility("default"))) const char* strata_library_interface(); \
  const char* strata_library_interface() {                                                  \
    static const std::string text = ::strata::runtime::library_interface();                 \
    return text.c_str();                                                                    \
  }                                                                                         \
  extern "C" __attribute__((visibility("default"))) void strata_register_components(        \
      ::strata::runtime::Registry& registry);                                               \
  void strata_register_components(::strata::runtime::Registry& registry)
