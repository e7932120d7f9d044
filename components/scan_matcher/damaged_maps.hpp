// SPDX-License-Identifier: Apache-2.0
/// Maps that a mapper saved, and of which a bad disk left a part.
#pragma once

#include <filesystem>
#include <optional>

#include "core/base/damage.hpp"

namespace strata::scan_matcher {

/// The log that summary.json names of maps that a live mapper saved.
inline constexpr const char* kLiveLog = "live";

/// What is wrong with live maps in this folder: their store is gone or empty, or their summary
/// cannot be read. Nothing for whole ones, for none, and for a folder that is another's.
[[nodiscard]] std::optional<DamageError> damage_of_live_maps(const std::filesystem::path& folder);

}  // namespace strata::scan_matcher
