// SPDX-License-Identifier: Apache-2.0
/// `strata info` of what components keep to go on with after a restart (docs/restarts.md).
#pragma once

#include <filesystem>

namespace strata::tools {

/// Prints what a component keeps in a file, or what is kept in a folder, as text or as JSON. A
/// component may be writing it. False, and nothing is printed, when there is nothing of the kind.
[[nodiscard]] bool print_kept(const std::filesystem::path& path, bool json);

}  // namespace strata::tools
