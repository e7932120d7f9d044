// SPDX-License-Identifier: Apache-2.0
/// The pieces that MCAP files are made of.
#pragma once

#include <cstdint>
#include <string_view>

namespace strata::log {

constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

enum McapOpcode : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kMetadata = 12,
  kMetadataIndex = 13,
  kSummaryOffset = 14,
  kDataEnd = 15,
};

}  // namespace strata::log
