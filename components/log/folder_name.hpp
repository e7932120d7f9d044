// SPDX-License-Identifier: Apache-2.0
/// How a folder is named, whoever typed its name.
#pragma once

#include <filesystem>

namespace strata::log {

/// "maps/" as "maps": with the slash, std::filesystem sees a folder without a name, and what is to
/// lie beside it would lie in it. O(length).
[[nodiscard]] inline std::filesystem::path without_slash(const std::filesystem::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace strata::log
