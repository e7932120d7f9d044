// SPDX-License-Identifier: Apache-2.0
/// Knowing over UDP that everything before has come.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "components/bus/endpoint.hpp"

namespace strata::test {

/// From now on participants of this process send each other datagrams, where Fast DDS else calls
/// the reader from the thread that writes.
void send_over_udp_within_the_process();

/// From one participant to another of this process, both on loopback: a participant reads its
/// topics from one socket, in the order in which datagrams came.
class Fence {
 public:
  Fence(const std::shared_ptr<bus::Participant>& from, const std::shared_ptr<bus::Participant>& to,
        const std::string& topic);
  /// Waits until what `from` has published is with `to`'s readers. Fails the test after a minute,
  /// or when it did not go over UDP.
  void pass();

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::uint32_t arrived_ = 0;          // under mutex_
  bool is_on_writers_thread_ = false;  // under mutex_
  std::uint32_t sent_ = 0;
  std::unique_ptr<bus::RawReader> reader_;  // before the writer: it is given messages
  std::unique_ptr<bus::RawWriter> writer_;
};

}  // namespace strata::test
