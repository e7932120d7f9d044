// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.hpp"

#include <utility>

namespace strata {

Error::Error(std::string place, std::string what, std::string remedy)
    : std::runtime_error(place + ": " + what + "; " + remedy),
      place_(std::move(place)),
      problem_(std::move(what)),
      remedy_(std::move(remedy)) {}

Cancelled::Cancelled(std::string place)
    : Error(std::move(place), "stopped on request", "start again to go on") {}

}  // namespace strata
