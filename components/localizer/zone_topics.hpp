// SPDX-License-Identifier: Apache-2.0
/// The zones of a site as masks for nav2's costmap filters, again whenever somebody changes them.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "components/localizer/filter_mask.hpp"
#include "components/site/site.hpp"
#include "core/base/config.hpp"
#include "core/base/time.hpp"

namespace strata::localizer {

struct ZoneTopicsConfig {
  std::string topic = "zones";
  double preferred_cost_percent = site::MaskConfig{}.preferred_cost_percent;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("topic", c.topic,
            {.doc = "the zones of each kind go out on TOPIC/keepout, preferred, speed, speed_m_s, "
                    "never_learn and static_only (nav_msgs/OccupancyGrid), and what they mean on "
                    "TOPIC/KIND_info (nav2_msgs/CostmapFilterInfo); empty: they do not"});
    v.field("preferred_cost_percent", c.preferred_cost_percent,
            {.doc = "what lies outside of preferred zones, where there are some, costs so much of "
                    "what a wall does",
             .unit = "%",
             .min = 1.0,
             .max = 99.0});
  }
};

class ZoneTopics {
 public:
  /// The topics of a mask of that kind.
  using Advertise = std::function<FilterMask(site::MaskKind kind)>;
  /// The node's time, from any thread.
  using Now = std::function<Stamp()>;

  ZoneTopics(const ZoneTopicsConfig& config, std::string map_frame, const Advertise& advertise,
             Now now);

  /// Sends the masks that are not as they were sent last, on the cells of the active map and of the
  /// zones that each shows. Zones that cannot be read leave all as they are, and those that make no
  /// mask leave that one. One thread at a time. O(cells).
  void tell(const site::Site& site);
  /// Why the zones are not used as they are now, or which does nothing; empty: all is well.
  /// Thread-safe.
  [[nodiscard]] std::string fault() const;

 private:
  struct Topic {
    site::MaskKind kind;
    FilterMask mask;
    std::optional<std::size_t> sent;  ///< a hash of the mask
  };
  /// Returns what is wrong with them, or which do nothing.
  std::string send(const site::Site& site);
  void send(Topic& topic, const site::Zones& zones, const ReflectionGrid& map);

  ZoneTopicsConfig config_;
  std::string map_frame_;
  Now now_;
  std::vector<Topic> topics_;
  mutable std::mutex mutex_;
  std::string fault_;  // under mutex_
};

}  // namespace strata::localizer
