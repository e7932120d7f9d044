// SPDX-License-Identifier: Apache-2.0
/// What time it is for a component: the machine's clock or, with use_sim_time, the last message on
/// /clock. Poses and maps take their stamps from the scans; this is for what has no scan.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "components/bus/endpoint.hpp"
#include "core/base/time.hpp"

namespace strata::runtime {

class NodeClock {
 public:
  /// stands_still: now() is 0 always; in lockstep nothing may depend on when it runs.
  NodeClock(std::shared_ptr<bus::Participant> participant, bool stands_still)
      : participant_(std::move(participant)), stands_still_(stands_still) {}

  /// Begins to listen to that topic, or ends to. When it throws, all is as before.
  void use_sim_time(bool on, const std::string& topic = "/clock");
  [[nodiscard]] bool uses_sim_time() const { return sim_time_; }
  /// Messages on /clock that were none.
  [[nodiscard]] std::uint64_t undecodable() const { return reader_ ? reader_->undecodable() : 0; }
  /// Of /clock, while that is listened to.
  [[nodiscard]] std::optional<bus::Guid> reader_guid() const;
  /// With use_sim_time 0 until the first /clock, as in ROS 2. From any thread.
  [[nodiscard]] Stamp now() const;

 private:
  std::shared_ptr<bus::Participant> participant_;
  bool stands_still_;
  std::atomic<bool> sim_time_{false};
  std::atomic<std::int64_t> last_ns_{0};
  std::unique_ptr<bus::Reader<rosgraph_msgs::msg::Clock>> reader_;
};

}  // namespace strata::runtime
