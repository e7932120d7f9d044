// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace strata::tools {

/// Whether a folder holds what a verb or a component left: maps, a localized run, a comparison and
/// so on, told by the files in it. False for bags.
[[nodiscard]] bool is_result_folder(const std::filesystem::path& path);

/// Prints what such a folder is and which files it has; of maps also what they were learned from
/// and what is in their store, if that can be read now. As text or as JSON.
void print_folder(const std::filesystem::path& path, bool json);

}  // namespace strata::tools
