// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/component_library.hpp"

#include <cstdlib>
#include <exception>
#include <sstream>

#include <dlfcn.h>

#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

using InterfaceOf = const char* (*)();
using RegisterInto = void (*)(Registry&);

std::vector<std::filesystem::path> folders_of(const Composition& composition) {
  std::vector<std::filesystem::path> folders{
      std::filesystem::absolute(composition.place).parent_path()};
  const char* variable = std::getenv(kLibraryPathVariable);
  std::istringstream list(variable == nullptr ? "" : variable);
  for (std::string folder; std::getline(list, folder, ':');) {
    if (!folder.empty()) folders.emplace_back(folder);
  }
  return folders;
}

/// The file of a library; a bare file name is for the system's loader to find.
std::filesystem::path find_library(const std::string& name, const Composition& composition) {
  const std::vector<std::filesystem::path> folders = folders_of(composition);
  if (name.find('/') != std::string::npos) return (folders.front() / name).lexically_normal();
  const std::filesystem::path file = name.ends_with(".so") ? name : "lib" + name + ".so";
  for (const std::filesystem::path& folder : folders) {
    std::error_code unreadable;
    if (std::filesystem::exists(folder / file, unreadable)) return folder / file;
  }
  return file;
}

void* open_library(const LibraryEntry& entry, const std::filesystem::path& file) {
  // Its names stay its own: two libraries may be linked with different copies of the same thing.
  if (void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) return library;
  const char* reason = dlerror();
  throw ConfigError(entry.place,
                    "library '" + entry.name +
                        "' does not load: " + (reason == nullptr ? "no reason given" : reason),
                    std::string("put it beside the composition or into a folder of ") +
                        kLibraryPathVariable + ", or give its path");
}

/// What the library says it has, not yet among the others.
Registry components_of(void* library, const LibraryEntry& entry) {
  const auto interface_of =
      reinterpret_cast<InterfaceOf>(dlsym(library, "strata_library_interface"));
  const auto register_into =
      reinterpret_cast<RegisterInto>(dlsym(library, "strata_register_components"));
  if (interface_of == nullptr || register_into == nullptr) {
    throw ConfigError(entry.place, "library '" + entry.name + "' has no components",
                      "write STRATA_COMPONENT_LIBRARY once in it");
  }
  const std::string theirs = interface_of();
  if (theirs != library_interface()) {
    throw ConfigError(
        entry.place,
        "library '" + entry.name + "' was built for " + theirs + "; this is " + library_interface(),
        "build it again with the package of this version");
  }
  Registry registry;
  try {
    register_into(registry);
  } catch (const std::exception& error) {
    throw ConfigError(entry.place,
                      "library '" + entry.name + "' does not register: " + error.what(),
                      "see the library's own documentation");
  }
  return registry;
}

}  // namespace

std::vector<std::filesystem::path> load_component_libraries(const Composition& composition,
                                                            Registry& registry) {
  std::vector<std::filesystem::path> files;
  for (const LibraryEntry& entry : composition.libraries) {
    files.push_back(find_library(entry.name, composition));
    const Registry theirs = components_of(open_library(entry, files.back()), entry);
    for (const auto& [type, factory] : theirs.factories()) {
      if (registry.factories().contains(type)) {
        throw ConfigError(entry.place,
                          "library '" + entry.name + "' has a second component type '" + type + "'",
                          "rename one of the two types");
      }
      registry.add(type, factory);
    }
  }
  return files;
}

}  // namespace strata::runtime
