// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace strata::tools {

/// Prints the topics of a bag that has no scans, or not only one topic of them, as text or as JSON
/// with the fields that `info` has for any log; `scans` is null. why: what keeps it from being read
/// as a log of scans. False, and nothing is printed, when there is no message in it. Throws
/// InputError when it is no bag.
[[nodiscard]] bool print_bag(const std::filesystem::path& path, const std::string& format,
                             const std::string& why, bool json);

}  // namespace strata::tools
