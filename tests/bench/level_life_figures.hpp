// SPDX-License-Identifier: Apache-2.0
/// How long the usual levels keep an old state, against theory.
#pragma once

#include <filesystem>

namespace strata::memory::level_life {

/// Prints survival, adaptation and forgetting as a Markdown table; draws half_lives.png and
/// forgetting.png into `out`.
void figures(const std::filesystem::path& out);

}  // namespace strata::memory::level_life
