// SPDX-License-Identifier: Apache-2.0
/// Maps that come over topics, as far as they have come.
#pragma once

#include "strata_idl/nav_msgs.h"
#include "strata_idl/strata_msgs.h"

#include "components/localizer/config.hpp"
#include "components/maps/map_models.hpp"

namespace strata::localizer {

class LiveMaps {
 public:
  /// model: the one that the maps are for. Throws ConfigError where it is made of what comes over
  /// no topic.
  LiveMaps(maps::MapModels::Pointer model, const MapTopicsConfig& config);

  /// Whether the model is made from the topic of this part, or needs it as free space.
  [[nodiscard]] bool needs(maps::MapPart part) const;

  /// What is known before anything comes; no news.
  void begin_with(const maps::Maps& maps) { maps_ = maps; }

  /// Throw InputError for messages that are no map.
  void add(const nav_msgs::msg::OccupancyGrid& message);
  void add(const strata_msgs::msg::ReflectionGrid& message);
  void add(const strata_msgs::msg::PatchMap& message);
  void add(const strata_msgs::msg::NodeMap& message);

  /// Everything the model needs is there, and something of it is new since the last take.
  [[nodiscard]] bool has_news() const { return is_new_ && is_complete(); }
  [[nodiscard]] const maps::Maps& take();

 private:
  [[nodiscard]] bool is_complete() const;

  maps::MapModels::Pointer model_;
  MapTopicsConfig config_;
  maps::Maps maps_;
  bool is_new_ = false;
};

}  // namespace strata::localizer
