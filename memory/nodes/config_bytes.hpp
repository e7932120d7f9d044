// SPDX-License-Identifier: Apache-2.0
/// A TimescaleConfig as bytes, field by field with its name, so that a later version that has more
/// fields can still read it.
#pragma once

#include "memory/levels/bytes.hpp"
#include "memory/nodes/timescale_config.hpp"

namespace strata::memory {

void write_config(const TimescaleConfig& config, ByteWriter& out);
/// Fields that are not there keep their defaults.
[[nodiscard]] TimescaleConfig read_config(ByteReader& in);

}  // namespace strata::memory
