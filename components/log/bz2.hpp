// SPDX-License-Identifier: Apache-2.0
/// bzip2, for the chunks of ROS 1 bags.
#pragma once

#include <cstdint>
#include <string>

#include "components/log/compression.hpp"

namespace strata::log {

/// Unpacks one bzip2 stream. Memory grows with what really comes out, to `limit` at most. `error`
/// is empty, or says why what came out ends early. O(bytes).
[[nodiscard]] Bytes unpack_bz2(View packed, std::uint64_t limit, std::string& error);

}  // namespace strata::log
