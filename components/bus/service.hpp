// SPDX-License-Identifier: Apache-2.0
/// ROS 2 services: a request topic and a reply topic, and a way to tell whose reply it is. The RMWs
/// do the last differently, and a server here answers each client in its own way:
///
/// - Fast DDS (rmw_fastrtps, Connext): the reply names the request in RTPS' related sample
/// identity;
///   the request may name the reader that waits for it there.
/// - Cyclone DDS (rmw_cyclonedds): request and reply begin with 16 bytes, the client's number and
///   that of the request, in front of the message.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "components/bus/endpoint.hpp"

namespace strata::bus {

/// A request and how to answer it.
struct ServiceRequest {
  std::vector<std::uint8_t> cdr;  ///< the request message, with its four-byte header
  Guid client{};                  ///< an entity of the participant that asks
  SampleIdentity reply_to;        ///< what the reply is related to
  /// Cyclone's words in front of the message, as they came; a reply begins with the same.
  std::optional<std::array<std::uint8_t, 16>> prefix;
  bool is_big_endian = false;
};

/// Tells the two kinds apart by the maker that the writer's GUID names. Throws InputError when the
/// bytes are too few.
[[nodiscard]] ServiceRequest read_service_request(const RawMessage& message);
/// The bytes of a reply: `cdr`, with the request's prefix when it had one.
[[nodiscard]] std::vector<std::uint8_t> service_reply_bytes(const ServiceRequest& request,
                                                            const std::vector<std::uint8_t>& cdr);

/// Answers one service. The first replies to a client of Cyclone DDS go out at once and, from a
/// thread of their own, again a moment later: its reader says that it is matched before it listens,
/// and what comes in between is lost for good. A client passes over an answer that it has had. Long
/// replies are held for that moment instead.
class ServiceServer {
 public:
  /// name: full ("/localizer/get_state"); type: "lifecycle_msgs/srv/GetState". on_request and
  /// on_match are called on threads of the middleware; after on_match call flush().
  ServiceServer(const std::shared_ptr<Participant>& participant, const std::string& name,
                const std::string& type, const QosProfile& qos,
                std::function<void(ServiceRequest)> on_request, std::function<void()> on_match);

  /// Sends a reply, at once or when the client's reader has been discovered. What cannot be sent,
  /// or waits behind 256 others, is dropped.
  void reply(const ServiceRequest& request, const std::vector<std::uint8_t>& cdr);
  /// Sends the replies that can be sent now and drops those that waited for longer than 2 s.
  void flush();

  [[nodiscard]] Guid reader_guid() const { return reader_.guid(); }
  [[nodiscard]] Guid writer_guid() const { return writer_.guid(); }

 private:
  struct Waiting {
    std::vector<std::uint8_t> bytes;
    Guid client{};
    SampleIdentity related;
    bool is_for_cyclone = false;
    std::chrono::steady_clock::time_point not_before;
    std::chrono::steady_clock::time_point deadline;
  };
  void hold(Waiting waiting);    // under mutex_
  void send_what_can_be_sent();  // under mutex_
  void send_later(const std::stop_token& stop);
  [[nodiscard]] std::chrono::steady_clock::time_point settled(const Guid& client);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  Caught unsent_;                                                  // replies
  std::deque<Waiting> waiting_;                                    // under mutex_
  std::map<Guid, std::chrono::steady_clock::time_point> settled_;  // Cyclone's clients; the same
  RawWriter writer_;
  RawReader reader_;
  std::jthread later_;  // last: it uses the others; started for the first client of Cyclone
};

/// Asks one service, in the way of Fast DDS.
class ServiceClient {
 public:
  ServiceClient(const std::shared_ptr<Participant>& participant, const std::string& name,
                const std::string& type);
  /// The reply's bytes; none when no server is found or none answers before the timeout. One call
  /// at a time.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> call(
      const std::vector<std::uint8_t>& request, std::chrono::milliseconds timeout);

 private:
  void take(RawMessage message);
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<RawMessage> replies_;  // under mutex_
  RawWriter writer_;
  RawReader reader_;  // last: its callback uses the others
};

/// S: a tag of bus::srv. The reply, or none as ServiceClient::call.
template <typename S>
[[nodiscard]] std::optional<typename ServiceType<S>::Response> call_service(
    const std::shared_ptr<Participant>& participant, const std::string& name,
    const typename ServiceType<S>::Request& request, std::chrono::milliseconds timeout) {
  ServiceClient client(participant, name, ServiceType<S>::name);
  const auto reply = client.call(convert::to_cdr(request), timeout);
  if (!reply) return std::nullopt;
  return convert::from_cdr<typename ServiceType<S>::Response>(*reply, name);
}

}  // namespace strata::bus
