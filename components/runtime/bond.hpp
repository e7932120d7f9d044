// SPDX-License-Identifier: Apache-2.0
/// The heartbeat by which nav2's lifecycle manager sees that a node it activated still lives: both
/// sides tell /bond several times a second that they are there, and one that is not heard for the
/// other's timeout counts as dead. Ours answers only who asks: without a manager nothing is sent.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "components/bus/endpoint.hpp"

namespace strata::runtime {

class Bond {
 public:
  /// id: as the manager calls the bond, the node's name without its namespace.
  Bond(const std::shared_ptr<bus::Participant>& participant, const std::string& topic,
       std::string id);

  /// Sends a heartbeat while a manager is heard; forgets one that is silent for its own timeout.
  /// Call several times a second while the node is active, from any thread.
  void tick();
  /// Tells the manager that the node goes; until it asks again nothing is sent.
  void end();

  /// Whether a manager is heard.
  [[nodiscard]] bool is_formed() const;
  /// Messages on the bond's topic that were none.
  [[nodiscard]] std::uint64_t undecodable() const { return reader_.undecodable(); }
  [[nodiscard]] bus::Guid reader_guid() { return reader_.raw().guid(); }
  [[nodiscard]] bus::Guid writer_guid() { return writer_.raw().guid(); }

 private:
  using Clock = std::chrono::steady_clock;
  void hear(const bond::msg::Status& status);
  void send(bool active);

  std::string id_;
  mutable std::mutex mutex_;
  std::optional<Clock::time_point> heard_until_;  // under mutex_
  bool must_answer_end_ = false;                  // under mutex_
  bus::Writer<bond::msg::Status> writer_;
  std::string instance_id_;  ///< of this side, after its writer; the manager's differs
  bus::Reader<bond::msg::Status> reader_;  // last: its callback uses the others
};

}  // namespace strata::runtime
