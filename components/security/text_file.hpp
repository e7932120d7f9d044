// SPDX-License-Identifier: Apache-2.0
/// Small files whole: read, and written so that no reader sees half of one.
#pragma once

#include <filesystem>
#include <string>

namespace strata::security {

/// Throws InputError when it is not there or is longer than a mebibyte.
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

/// is_secret: readable by its owner only, from its first byte on. Throws OutputError.
void write_text(const std::filesystem::path& file, const std::string& text, bool is_secret = false);

}  // namespace strata::security
