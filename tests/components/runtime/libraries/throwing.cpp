// SPDX-License-Identifier: Apache-2.0
/// Cannot register what it has.
#include <stdexcept>

#include "components/runtime/component_library.hpp"

STRATA_COMPONENT_LIBRARY(/*registry*/) { throw std::runtime_error("no licence file"); }
