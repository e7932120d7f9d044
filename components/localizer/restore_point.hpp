// SPDX-License-Identifier: Apache-2.0
/// From where another process can go on with a localizer to the same bits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "strata_idl/rcl_interfaces.h"

#include "components/localizer/map_message.hpp"
#include "core/base/time.hpp"

namespace strata::localizer {

/// Private topics; hidden ones, by ROS 2's rule for names: who records everything leaves them out.
inline constexpr const char* kRestorePointTopic = "_restore_point";
inline constexpr const char* kJournalTopic = "_journal";

struct RestorePoint {
  std::string localizer;  ///< "/robot1/localizer"
  Stamp stamp;            ///< of the next scan
  /// The number of the next scan in the journal; a localizer that is started again has others.
  std::uint64_t next_scan = 0;
  /// The scans before led here; false where a pose was set, a search asked for or a map taken.
  bool goes_on = false;
  std::uint64_t seed = 0;
  std::string settings;     ///< LocalizerComponentConfig as YAML, every key
  std::string maps;         ///< the folder without links: of a site, its version's
  std::string maps_sha256;  ///< log::content_digest; empty: none was read
  /// What came over topics in the place of the folder's, in the order in which it came last.
  std::vector<MapMessage> map_messages;
  std::vector<std::uint8_t> state;  ///< localization::Localizer::saved_state
};

/// As named values, the message that ROS 2 has for such.
[[nodiscard]] rcl_interfaces::msg::ParameterEvent to_message(const RestorePoint& point);
/// Throws InputError when a value is missing or of another type.
[[nodiscard]] RestorePoint restore_point(const rcl_interfaces::msg::ParameterEvent& message);

}  // namespace strata::localizer
