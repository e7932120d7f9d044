// SPDX-License-Identifier: Apache-2.0
/// Scans and odometry out of a bag's messages.
#pragma once

#include <filesystem>

#include "components/log/log_reader.hpp"

namespace strata::log {

/// Stamps are those of the message headers. The scan's frame is connected to the robot by
/// tf_static; a laser mounted upside down is turned round, so that its beams run counter-clockwise
/// again.
[[nodiscard]] LogContent read_bag(const std::filesystem::path& path, const ReadOptions& options,
                                  ReadReport& report);

}  // namespace strata::log
