// SPDX-License-Identifier: Apache-2.0
/// A topic that a component reads, and what waits of it.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "components/runtime/component.hpp"
#include "components/runtime/sequence_watch.hpp"
#include "components/runtime/time_histogram.hpp"

namespace strata::runtime {

struct Component::Subscription {
  std::string topic;
  std::string label;      ///< the topic, for figures; of its second reader another
  std::size_t depth = 0;  // live: as many messages may wait; 0: all
  bool latched = false;
  bool until_active = false;      // live: messages wait until the component is active
  bool at_ticks = false;          // Reception's
  std::size_t latched_depth = 0;  // Reception's
  std::function<void(const bus::RawMessage&)> callback;
  struct Waiting {
    bus::RawMessage message;
    std::chrono::steady_clock::time_point came;
  };
  std::mutex mutex;
  std::deque<Waiting> waiting;    // under mutex
  std::size_t waiting_bytes = 0;  // under mutex
  std::uint64_t received = 0;     // under mutex
  SequenceWatch sequences;        // under mutex
  TimeHistogram work_times;       // live, on the mailbox: how long its messages were worked on
  TimeHistogram latencies;        // ... and from when they were written to the end of that
  std::unique_ptr<bus::RawReader> reader;

  [[nodiscard]] std::size_t count_waiting() {
    const std::lock_guard lock(mutex);
    return waiting.size();
  }
  /// Under mutex: gives up what the last one replaces, as Reception::latched_depth says; how many.
  std::size_t drop_replaced() {
    const bus::Guid writer = waiting.back().message.identity.writer;
    const auto burst = waiting.back().came - Reception::kBurst;
    const auto is_replaced = [&](const Waiting& other) {
      return other.message.identity.writer == writer;
    };
    auto left =
        static_cast<std::size_t>(std::count_if(waiting.begin(), waiting.end(), is_replaced));
    std::size_t dropped = 0;
    for (auto it = waiting.begin(); left > latched_depth;) {
      if (!is_replaced(*it)) {
        ++it;
        continue;
      }
      if (it->came >= burst) break;
      waiting_bytes -= it->message.cdr.size();
      it = waiting.erase(it);
      --left;
      ++dropped;
    }
    return dropped;
  }
  /// On the mailbox.
  void tell(Health& health) {
    const std::lock_guard lock(mutex);
    health.add("received " + label, received);
    health.add("lost " + label, sequences.missing());
    if (work_times.count() > 0) health.add("work times " + label, work_times.text());
    if (latencies.count() > 0) health.add("latencies " + label, latencies.text());
  }
};

}  // namespace strata::runtime
