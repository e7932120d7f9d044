// SPDX-License-Identifier: Apache-2.0
/// A folder of results (trajectories, states, maps, JSON, recorded topics) as named values in order
/// of time: one form, so that one comparison serves all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/log/message_fields.hpp"
#include "core/base/time.hpp"

namespace strata::expect {

/// Below a folder of results: the bag with the topics that a replay recorded.
inline constexpr const char* kTopicsFolder = "topics";

/// One line of a file, one message of a topic, or a whole file.
struct Entry {
  std::optional<Stamp> stamp;
  std::vector<log::FieldValue> values;              ///< of a file
  std::function<std::string(std::size_t)> name_of;  ///< of values[i]: "x", "em.iterations"
  std::string type;                                 ///< of a message
  std::vector<std::uint8_t> bytes;                  ///< of a message
};

/// The entries of one file or topic.
struct Series {
  std::string unit = "entry";  ///< what an entry is: "scan", "message", "row"
  std::vector<Entry> entries;
};

/// By name: "trajectory.tum", "/amcl_pose".
using Results = std::map<std::string, Series>;

/// Reads trajectory.tum, states.csv, *.json, map_server *.yaml, and topics/, in `folder` and below;
/// other files (images beside their .yaml, strata.db, which holds the same again) are left alone.
/// Throws InputError.
[[nodiscard]] Results read_results(const std::filesystem::path& folder);

/// The topics recorded in a folder of results, as "/amcl_pose:geometry_msgs/msg/...".
[[nodiscard]] std::vector<std::string> recorded_topics(const std::filesystem::path& folder);

}  // namespace strata::expect
