// SPDX-License-Identifier: Apache-2.0
/// The built program, run from a test.
#pragma once

#include <string>

#include "tests/support/command.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {

/// Runs `PREFIX strata ARGUMENTS`.
inline Outcome run_strata_under(const std::string& prefix, const std::string& arguments) {
  return run_command(prefix + " '" STRATA_PROGRAM "' " + arguments);
}

inline Outcome run_strata(const std::string& arguments) { return run_strata_under("", arguments); }

}  // namespace strata::test
