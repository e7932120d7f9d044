// SPDX-License-Identifier: Apache-2.0
/// A hub for two viewers, asked as viewers ask.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/live_view/view_hub.hpp"

namespace strata::live_view {

class ViewHubTest : public testing::Test {
 protected:
  ViewHub hub_{"strata", {"/initialpose", "/reinitialize_global_localization", ""}, 2};
  int woken_ = 0;

  ViewerId joined() {
    return hub_.join([this] { ++woken_; }).value();
  }
  static SharedMessage message(std::uint8_t content, std::uint8_t writer = 1) {
    ViewMessage made;
    made.stamp_ns = 7;
    made.writer[0] = writer;
    made.cdr = {0, 1, 0, 0, content};
    return std::make_shared<const ViewMessage>(made);
  }
  /// What is not binary, in order, until there is nothing more.
  std::vector<nlohmann::json> texts(ViewerId viewer) {
    std::vector<nlohmann::json> found;
    while (const auto frame = hub_.next(viewer)) {
      if (!frame->is_binary) found.push_back(nlohmann::json::parse(frame->head));
    }
    return found;
  }
  void subscribe(ViewerId viewer, std::uint32_t id, std::uint32_t channel) {
    hub_.take(viewer, false,
              nlohmann::json{{"op", "subscribe"},
                             {"subscriptions", {{{"id", id}, {"channelId", channel}}}}}
                  .dump());
  }
  /// The last bytes of the messages that wait for a viewer.
  std::vector<int> contents(ViewerId viewer) {
    std::vector<int> found;
    while (const auto frame = hub_.next(viewer)) {
      if (frame->message) found.push_back(frame->message->cdr.back());
    }
    return found;
  }
};

}  // namespace strata::live_view
