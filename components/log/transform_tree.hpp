// SPDX-License-Identifier: Apache-2.0
/// Frames that hang on each other, each at one place.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/pose3.hpp"

namespace strata::log {

/// The name without the leading slash of ROS 1.
[[nodiscard]] std::string frame_name(const std::string& frame);

class TransformTree {
 public:
  /// A later transform of the same child replaces the earlier. Names lose a leading slash.
  void add(const std::string& parent, const std::string& child, const Pose3& parent_from_child);
  void remove(const std::string& child) { links_.erase(frame_name(child)); }
  [[nodiscard]] bool empty() const { return links_.empty(); }
  /// target_from_source along the links, either way round; nothing when they are not connected.
  [[nodiscard]] std::optional<Pose3> find(const std::string& target,
                                          const std::string& source) const;
  /// Whether some transform names the frame. O(links).
  [[nodiscard]] bool knows(const std::string& frame) const;
  /// The frame that it hangs on in the end; its own where it hangs on none.
  [[nodiscard]] std::string root_of(const std::string& frame) const;

 private:
  std::map<std::string, std::pair<std::string, Pose3>> links_;  ///< child -> parent
};

}  // namespace strata::log
