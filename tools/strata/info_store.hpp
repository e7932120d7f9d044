// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strata::tools {

/// Prints what is in a strata.db, as text or as JSON. Throws InputError.
void print_store(const std::string& path, bool json);

}  // namespace strata::tools
