// SPDX-License-Identifier: Apache-2.0
/// What was recorded, for benchmarks that lose nothing.
#pragma once

#include <cstddef>
#include <filesystem>

#include "components/log/bag.hpp"

namespace strata::bench {

/// How many messages a bag holds. Throws InputError when it is none.
inline std::size_t messages_in(const std::filesystem::path& bag) {
  const auto reader = log::BagReader::open(bag);
  log::BagMessage message;
  std::size_t held = 0;
  while (reader->next(message)) ++held;
  return held;
}

}  // namespace strata::bench
