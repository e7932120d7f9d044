// SPDX-License-Identifier: Apache-2.0
/// A TimescaleConfig as bytes, field by field with its name, so that a later version that has more
/// fields can still read it.
#pragma once

#include "core/base/state_archive.hpp"
#include "memory/nodes/timescale_config.hpp"

namespace strata::memory {

void write_config(const TimescaleConfig& config, StateWriter& out);
/// Fields that are not there keep their defaults. Throws DamageError for values that none can have.
[[nodiscard]] TimescaleConfig read_config(StateReader& in);

}  // namespace strata::memory
