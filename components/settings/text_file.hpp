// SPDX-License-Identifier: Apache-2.0
/// What may be read as a text of settings.
#pragma once

#include <filesystem>

namespace strata::settings {

/// Throws InputError for an empty name, and for a device (/dev/zero), which may have no end. What
/// is not there is left to whoever opens it.
void require_text_file(const std::filesystem::path& file);

}  // namespace strata::settings
