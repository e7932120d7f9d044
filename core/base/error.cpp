// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.hpp"

#include <utility>

namespace strata {
namespace {

/// Bytes of a damaged file get into what is told of it: zeros would end the line, others move the
/// cursor.
std::string printable(std::string text) {
  for (char& c : text) {
    const bool is_control = (c >= '\0' && c < ' ' && c != '\n') || c == '\x7f';
    if (is_control) c = '?';
  }
  return text;
}

}  // namespace

Error::Error(std::string place, std::string what, std::string remedy)
    : std::runtime_error(printable(place + ": " + what + "; " + remedy)),
      place_(std::move(place)),
      problem_(std::move(what)),
      remedy_(std::move(remedy)) {}

Cancelled::Cancelled(std::string place)
    : Error(std::move(place), "stopped on request, and nothing was changed",
            "the same command begins anew") {}

}  // namespace strata
