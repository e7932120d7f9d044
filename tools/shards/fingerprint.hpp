// SPDX-License-Identifier: Apache-2.0
/// What files hold, in one short text, so that two machines know whether they have the same.
#pragma once

#include <filesystem>
#include <string>

namespace strata::shards {

/// SHA-256 in hexadecimal of a file's content; of a folder (a bag), of the names and contents in
/// it, wherever it lies. Throws InputError. O(bytes).
[[nodiscard]] std::string fingerprint(const std::filesystem::path& path);

/// Of the program that runs.
[[nodiscard]] std::string fingerprint_of_program();

}  // namespace strata::shards
