// SPDX-License-Identifier: Apache-2.0
/// A mask for one of nav2's costmap filters, with the message that says what it means.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "components/bus/message_types.hpp"
#include "components/site/zone_masks.hpp"
#include "core/base/time.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::localizer {

[[nodiscard]] nav2_msgs::msg::CostmapFilterInfo filter_info(const site::FilterMeaning& meaning,
                                                            const std::string& mask_topic,
                                                            Stamp stamp, const std::string& frame);

/// The two topics of a mask; for one thread at a time.
class FilterMask {
 public:
  using SendMask = std::function<void(const nav_msgs::msg::OccupancyGrid&)>;
  using SendInfo = std::function<void(const nav2_msgs::msg::CostmapFilterInfo&)>;

  /// topic: of the mask, resolved.
  FilterMask(std::string topic, SendMask send_mask, SendInfo send_info);
  /// The meaning goes out first, and only when it is another one than before: with each nav2
  /// subscribes to its mask anew.
  void send(const ReflectionGrid& values, const site::FilterMeaning& meaning, Stamp stamp,
            const std::string& frame);

 private:
  std::string topic_;
  SendMask send_mask_;
  SendInfo send_info_;
  std::optional<site::FilterMeaning> told_;
};

}  // namespace strata::localizer
