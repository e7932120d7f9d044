// SPDX-License-Identifier: Apache-2.0
/// As if it had been built against an older package.
#define EXPORTED extern "C" __attribute__((visibility("default")))

EXPORTED const char* strata_library_interface() { return "strata 0.0.1"; }
EXPORTED void strata_register_components(void* /*registry*/) { __builtin_trap(); }
