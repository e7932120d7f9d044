// SPDX-License-Identifier: Apache-2.0
/// The last minute of every topic, in memory.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "components/bus/endpoint.hpp"
#include "core/base/time.hpp"

namespace strata::incident_recorder {

/// A topic as a bag names it.
struct KeptTopic {
  std::string name;
  std::string type;
  std::string offered_qos;  ///< rosbag2's text
  bool is_latched = false;
  std::string type_hash = {};  ///< as the writers tell it
};

struct KeptMessage {
  std::shared_ptr<const KeptTopic> topic;
  bus::Guid writer;
  Stamp stamp;  ///< bus::stamp_to_record
  std::chrono::steady_clock::time_point came;
  std::vector<std::uint8_t> cdr;
};

using KeptMessagePtr = std::shared_ptr<const KeptMessage>;

/// Not thread safe; messages that were handed out stay as they are. Adding is O(1) on average.
class MessageRing {
 public:
  using Clock = std::chrono::steady_clock;

  /// span: how long a message stays. max_bytes: of all messages; beyond that the oldest go, before
  /// their time.
  MessageRing(std::chrono::duration<double> span, std::size_t max_bytes);

  /// In the order in which they come.
  void add(KeptMessagePtr message);
  /// Forgets what is too old now. Of a latched topic the last message of each writer stays: it
  /// still holds.
  void forget(Clock::time_point now);
  /// What holds at the beginning of the span, and then what came within it, in order. What holds
  /// is stamped as if it had come at that beginning, since a player waits between stamps.
  [[nodiscard]] std::vector<KeptMessagePtr> messages() const;

  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Messages that had to go before their time.
  [[nodiscard]] std::uint64_t gone_early() const { return gone_early_; }

 private:
  void forget_first();
  void fit();
  std::chrono::duration<double> span_;
  std::size_t max_bytes_;
  std::deque<KeptMessagePtr> recent_;
  std::map<std::pair<std::string, bus::Guid>, KeptMessagePtr> latched_;  ///< older than recent_
  std::size_t bytes_ = 0;
  std::uint64_t gone_early_ = 0;
};

}  // namespace strata::incident_recorder
