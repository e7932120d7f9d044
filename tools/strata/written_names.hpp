// SPDX-License-Identifier: Apache-2.0
/// What verbs write into a folder, by name, so that a file of somebody else is told from theirs.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace strata::tools {

/// Patterns of fnmatch(3) for all that is written into the top of a folder of that kind; none for a
/// kind that is not known. tests/rough/outputs.py puts a file under each name that a verb writes.
[[nodiscard]] std::span<const char* const> written_names(std::string_view kind);

/// The first entry of `folder`, by name, that results of that kind would replace; empty when there
/// is none, or no such folder.
[[nodiscard]] std::string entry_in_the_way(const std::filesystem::path& folder,
                                           std::string_view kind);

}  // namespace strata::tools
