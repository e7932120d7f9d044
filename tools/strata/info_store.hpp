// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace strata::tools {

/// What is in a strata.db. Throws InputError.
[[nodiscard]] nlohmann::ordered_json describe_store(const std::string& path);

/// Prints what is in a strata.db, as text or as JSON. Throws InputError.
void print_store(const std::string& path, bool json);

/// "12.3 kB".
[[nodiscard]] std::string kilobytes(std::uintmax_t bytes);

}  // namespace strata::tools
