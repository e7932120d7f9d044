// SPDX-License-Identifier: Apache-2.0
/// What components keep in files (docs/restarts.md), told by how the files begin.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace strata::log {

inline constexpr std::string_view kStateOfScanMatcher = "saved state of strata::ScanMatcher";
inline constexpr std::string_view kStateOfBeamFilter = "saved state of strata::BeamFilter";
inline constexpr std::string_view kStateOfPatchLearner = "saved state of strata::PatchLearner";
inline constexpr std::string_view kLastPose = "last pose of strata::Localizer";
inline constexpr std::string_view kOctree = "octree, as strata::VolumeMapper keeps it";
inline constexpr std::string_view kDatabase = "SQLite file, such as strata.db of a maps folder";

/// One of the above, a state with its version; empty when it is none of them or cannot be read.
/// Reads no more than the begin of the file: a damaged one may be told, too.
[[nodiscard]] std::string kept_in_words(const std::filesystem::path& file);

/// For the file that a component is to keep what is `own`, one of the above, in. Throws ConfigError
/// when it is another of them, and leaves it as it is. setting: that names the file.
void require_own_file(const std::filesystem::path& file, std::string_view own,
                      const std::string& setting);

}  // namespace strata::log
