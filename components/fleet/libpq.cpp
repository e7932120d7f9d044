// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/libpq.hpp"

#include <string>

#include <dlfcn.h>

#include "core/base/error.hpp"

namespace strata::fleet {
namespace {

constexpr const char* kName = "libpq.so.5";

[[noreturn]] void fail() {
  const char* why = dlerror();
  throw OutputError(kName, "cannot be loaded: " + std::string(why != nullptr ? why : "unknown"),
                    "install it (Debian: libpq5), and give the program more address space if there "
                    "is a limit");
}

}  // namespace

/// Never unloaded: results and connections may outlive everything else.
void* Libpq::load() {
  void* library = dlopen(kName, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) fail();
  return library;
}

void* Libpq::symbol(const char* name) const {
  void* found = dlsym(library_, name);
  if (found == nullptr) fail();
  return found;
}

const Libpq& libpq() {
  static const Libpq loaded;
  return loaded;
}

}  // namespace strata::fleet
