// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/clock.hpp"

#include <chrono>

#include "components/convert/geometry_messages.hpp"

namespace strata::runtime {

void NodeClock::use_sim_time(bool on, const std::string& topic) {
  if (!on) {
    reader_.reset();
  } else if (!reader_ && !stands_still_) {
    last_ns_ = 0;
    reader_ = std::make_unique<bus::Reader<rosgraph_msgs::msg::Clock>>(
        participant_, topic, bus::qos_profile("clock"),
        [this](const rosgraph_msgs::msg::Clock& message) {
          last_ns_ = convert::from_message(message.clock()).ns;
        });
  }
  sim_time_ = on;  // now: without a reader time would stand still
}

std::optional<bus::Guid> NodeClock::reader_guid() const {
  if (!reader_) return std::nullopt;
  return reader_->raw().guid();
}

Stamp NodeClock::now() const {
  if (stands_still_) return {};
  if (sim_time_) return {last_ns_};
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count()};
}

}  // namespace strata::runtime
