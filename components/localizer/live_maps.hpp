// SPDX-License-Identifier: Apache-2.0
/// Maps that come over topics, as far as they have come.
#pragma once

#include <vector>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/strata_msgs.h"

#include "components/localizer/config.hpp"
#include "components/localizer/map_message.hpp"
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
  void begin_with(const maps::Maps& maps);

  /// Somebody keeps the messages to make the maps again: a node map is then made of its message
  /// alone, without the look-up table of the one before.
  void keep_apart(bool is_apart) { is_apart_ = is_apart; }

  /// from: by what a restore point names the message. Throw InputError for messages that are no
  /// map.
  void add(const nav_msgs::msg::OccupancyGrid& message, const MapMessage& from = {});
  void add(const strata_msgs::msg::ReflectionGrid& message, const MapMessage& from = {});
  void add(const strata_msgs::msg::PatchMap& message, const MapMessage& from = {});
  void add(const strata_msgs::msg::NodeMap& message, const MapMessage& from = {});

  /// Everything the model needs is there, and something of it is new since the last take.
  [[nodiscard]] bool has_news() const { return is_new_ && is_complete(); }
  [[nodiscard]] const maps::Maps& take();
  /// Of which messages the maps were that were taken last: added to what it began with, in this
  /// order, they give the same maps.
  [[nodiscard]] const std::vector<MapMessage>& taken() const { return taken_; }

 private:
  [[nodiscard]] bool is_complete() const;
  void note(const MapMessage& from);

  maps::MapModels::Pointer model_;
  MapTopicsConfig config_;
  maps::Maps maps_;
  bool is_new_ = false;
  bool is_apart_ = false;
  std::vector<MapMessage> came_;  ///< the last of each type
  std::vector<MapMessage> taken_;
};

}  // namespace strata::localizer
