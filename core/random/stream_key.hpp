// SPDX-License-Identifier: Apache-2.0
/// For kernels that draw many streams at once, and must get what RandomStream gives.
#pragma once

#include <array>
#include <cstdint>

#include "core/random/stream.hpp"

namespace strata {

/// The key that all streams of one seed and use have. Stream (step, index) takes its numbers from
/// the blocks philox4x32_10({0, index, step, step >> 32}, key), {1, index, ...}, ...
[[nodiscard]] std::array<std::uint32_t, 2> stream_key(std::uint64_t seed, StreamId stream);

}  // namespace strata
