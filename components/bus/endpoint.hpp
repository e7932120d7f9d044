// SPDX-License-Identifier: Apache-2.0
/// Writers and readers of one topic. The raw ones carry messages as CDR bytes, so that a recorder,
/// a player and a typed component can share a topic in one participant; the typed ones are a thin
/// layer above.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "components/bus/message_types.hpp"
#include "components/bus/names.hpp"
#include "components/bus/participant.hpp"
#include "components/bus/qos.hpp"
#include "components/convert/cdr.hpp"

namespace strata::bus {

/// What a message is known by: its writer and its number there.
struct SampleIdentity {
  Guid writer{};  ///< zero: unknown
  std::int64_t sequence_number = 0;
};

/// One message as it came.
struct RawMessage {
  std::vector<std::uint8_t> cdr;     ///< with its four-byte header
  SampleIdentity identity;           ///< its own
  SampleIdentity related;            ///< of the message that it answers, if it says so
  std::int64_t source_stamp_ns = 0;  ///< when it was written, by the writer's clock
};

/// Publishes CDR bytes. Thread safe.
class RawWriter {
 public:
  /// topic: full name ("/scan"); type: "sensor_msgs/msg/LaserScan". on_match: called, on a thread
  /// of the middleware, when the number of matched readers changes. Throws OutputError when the
  /// middleware refuses or grants another QoS.
  RawWriter(std::shared_ptr<Participant> participant, TopicName topic, const std::string& type,
            const QosProfile& qos, std::function<void()> on_match = nullptr);
  ~RawWriter();
  RawWriter(const RawWriter&) = delete;
  RawWriter& operator=(const RawWriter&) = delete;

  [[nodiscard]] const std::string& topic() const;
  /// Throws OutputError when the message cannot be handed over within 10 s (a reliable reader that
  /// does not keep up), InputError at once when it is shorter than the 4 bytes of its header.
  void publish(const std::vector<std::uint8_t>& cdr) { (void)publish(cdr, {}); }
  /// The same, saying to which message it belongs. Returns the message's own number.
  std::int64_t publish(const std::vector<std::uint8_t>& cdr, const SampleIdentity& related);
  /// Tells every reader now what has been published so far; needs QosProfile::manual_liveliness.
  void send_heartbeat();
  /// How many messages were published.
  [[nodiscard]] std::uint64_t count() const;
  [[nodiscard]] Guid guid() const;
  [[nodiscard]] int matched() const;
  /// Whether a reader of that participant is matched.
  [[nodiscard]] bool is_matched_with(const Guid& participant) const;
  /// Whether at least `readers` are matched before the timeout.
  [[nodiscard]] bool wait_for_readers(int readers, std::chrono::milliseconds timeout) const;
  /// The QoS in force, read back from the middleware.
  [[nodiscard]] QosProfile granted_qos() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Hands over each message as CDR bytes.
class RawReader {
 public:
  using Callback = std::function<void(RawMessage)>;
  /// callback: called on a thread of the middleware or, for a writer of the same process, on the
  /// thread that writes; never twice at a time. It must return soon and not publish; what it throws
  /// is counted (Participant::caught), and the next message is handed over.
  RawReader(std::shared_ptr<Participant> participant, TopicName topic, const std::string& type,
            const QosProfile& qos, Callback callback, std::function<void()> on_match = nullptr);
  /// After this no callback runs.
  ~RawReader();
  RawReader(const RawReader&) = delete;
  RawReader& operator=(const RawReader&) = delete;

  [[nodiscard]] const std::string& topic() const;
  [[nodiscard]] Guid guid() const;
  [[nodiscard]] int matched() const;
  [[nodiscard]] bool wait_for_writers(int writers, std::chrono::milliseconds timeout) const;
  [[nodiscard]] QosProfile granted_qos() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Publishes messages of type T.
template <typename T>
class Writer {
 public:
  Writer(std::shared_ptr<Participant> participant, TopicName topic, const QosProfile& qos,
         std::function<void()> on_match = nullptr)
      : raw_(std::make_shared<RawWriter>(std::move(participant), std::move(topic),
                                         MessageType<T>::name, qos, std::move(on_match))) {}
  void publish(const T& message) { raw_->publish(convert::to_cdr(message)); }
  [[nodiscard]] RawWriter& raw() { return *raw_; }
  [[nodiscard]] const std::shared_ptr<RawWriter>& share() const { return raw_; }

 private:
  std::shared_ptr<RawWriter> raw_;
};

/// Hands over messages of type T; callback as RawReader's. Bytes that do not decode are dropped and
/// counted.
template <typename T>
class Reader {
 public:
  Reader(std::shared_ptr<Participant> participant, const std::string& topic, const QosProfile& qos,
         std::function<void(T)> callback, std::function<void()> on_match = nullptr)
      : raw_(
            std::move(participant), topic, MessageType<T>::name, qos,
            [callback = std::move(callback), topic, this](RawMessage message) {
              try {
                callback(convert::from_cdr<T>(message.cdr, topic));
              } catch (const InputError&) {
                ++undecodable_;
              }
            },
            std::move(on_match)) {}
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  [[nodiscard]] RawReader& raw() { return raw_; }
  [[nodiscard]] std::uint64_t undecodable() const { return undecodable_; }

 private:
  std::atomic<std::uint64_t> undecodable_{0};
  RawReader raw_;
};

}  // namespace strata::bus
