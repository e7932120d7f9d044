// SPDX-License-Identifier: Apache-2.0
#include "components/bus/endpoint.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "components/bus/match_count.hpp"
#include "components/bus/participant_state.hpp"
#include "components/convert/type_hash.hpp"
#include "core/base/error.hpp"

namespace strata::bus {
namespace {

constexpr auto kPublishTimeout = std::chrono::seconds(10);

/// The hash of a type that we know, on a topic of ROS 2; both topics of a service tell that of the
/// whole service.
std::string hash_of(const TopicName& topic, const std::string& type) {
  if (topic.kind == TopicKind::kPlain) return convert::type_hash(type);
  return convert::type_hash(topic.kind == TopicKind::kTopic ? type
                                                            : type.substr(0, type.rfind('_')));
}

/// Sets what writers and readers have in common.
template <typename EndpointQos>
void apply_profile(const QosProfile& profile, const std::string& type_hash, EndpointQos& qos) {
  if (!type_hash.empty()) {
    const std::string text = "typehash=" + type_hash + ";";
    qos.user_data().setValue(std::vector<rtps::octet>(text.begin(), text.end()));
  }
  qos.reliability().kind =
      profile.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      profile.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = profile.depth == 0 ? dds::KEEP_ALL_HISTORY_QOS : dds::KEEP_LAST_HISTORY_QOS;
  if (profile.depth > 0) qos.history().depth = profile.depth;
  // Our types are unbounded: the plain policy would make every write fail.
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
}

template <typename EndpointQos>
QosProfile profile_of(const std::string& name, const EndpointQos& qos) {
  QosProfile result;
  result.name = name;
  result.reliable = qos.reliability().kind == dds::RELIABLE_RELIABILITY_QOS;
  result.transient_local = qos.durability().kind == dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  result.depth = qos.history().kind == dds::KEEP_ALL_HISTORY_QOS ? 0 : qos.history().depth;
  return result;
}

void require_granted(const QosProfile& asked, const QosProfile& granted, const std::string& topic) {
  if (asked.reliable == granted.reliable && asked.transient_local == granted.transient_local &&
      asked.depth == granted.depth) {
    return;
  }
  throw OutputError(topic, "the middleware changed the QoS profile '" + asked.name + "'",
                    "remove XML profiles that override endpoints");
}

/// Says why the middleware made no endpoint.
[[noreturn]] void refuse(const Participant::State& owner, const TopicName& topic,
                         const QosProfile& qos, bool writes) {
  const std::string verb = writes ? "write" : "read";
  if (!owner.is_secured) {
    throw OutputError(topic.full,
                      std::string("no ") + (writes ? "writer" : "reader") + " can be made",
                      "check the QoS profile " + qos.name);
  }
  throw OutputError(
      topic.full, "enclave " + owner.options.enclave + " may not " + verb + " " + wire_topic(topic),
      "allow it with `strata keystore permissions`");
}

Guid guid_of(const dds::InstanceHandle_t& handle) { return to_guid(rtps::iHandle2GUID(handle)); }

SampleIdentity from_wire(const rtps::SampleIdentity& identity) {
  const rtps::SequenceNumber_t& number = identity.sequence_number();
  if (identity.writer_guid() == rtps::GUID_t::unknown()) return {};
  return {to_guid(identity.writer_guid()), static_cast<std::int64_t>(number.to64long())};
}

rtps::SampleIdentity to_wire(const SampleIdentity& identity) {
  rtps::GUID_t guid;
  std::copy_n(identity.writer.begin(), 12, guid.guidPrefix.value);
  std::copy_n(identity.writer.begin() + 12, 4, guid.entityId.value);
  rtps::SampleIdentity result;
  result.writer_guid(guid);
  result.sequence_number(
      rtps::SequenceNumber_t(static_cast<std::int32_t>(identity.sequence_number >> 32),
                             static_cast<std::uint32_t>(identity.sequence_number & 0xFFFFFFFF)));
  return result;
}

}  // namespace

struct RawWriter::State : dds::DataWriterListener {
  explicit State(std::function<void()> on_match) : matches(std::move(on_match)) {}
  // Here and not in RawWriter: a constructor that throws must not leave the middleware our address.
  ~State() override;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  void on_publication_matched(dds::DataWriter* /*writer*/,
                              const dds::PublicationMatchedStatus& status) override {
    participant->state().caught.run([&] {
      matches.set(status.current_count, guid_of(status.last_subscription_handle),
                  status.current_count_change > 0);
    });
  }
  std::shared_ptr<Participant> participant;
  std::string topic;
  std::string profile;
  dds::DataWriter* writer = nullptr;
  std::atomic<std::uint64_t> count{0};
  MatchCount matches;
};

RawWriter::RawWriter(std::shared_ptr<Participant> participant, TopicName topic,
                     const std::string& type, const QosProfile& qos, std::function<void()> on_match)
    : state_(std::make_unique<State>(std::move(on_match))) {
  state_->participant = std::move(participant);
  state_->topic = topic.full;
  state_->profile = qos.name;
  Participant::State& owner = state_->participant->state();
  dds::DataWriterQos writer_qos = dds::DATAWRITER_QOS_DEFAULT;
  const std::string type_hash = hash_of(topic, type);
  apply_profile(qos, type_hash, writer_qos);
  writer_qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  if (qos.manual_liveliness) {
    writer_qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
  }
  if (qos.lifespan_s > 0.0) {
    writer_qos.lifespan().duration =
        eprosima::fastrtps::Duration_t(static_cast<long double>(qos.lifespan_s));
  }
  auto& times = writer_qos.reliable_writer_qos().times;
  times.heartbeatPeriod = eprosima::fastrtps::Duration_t(0, 100'000'000);
  times.nackResponseDelay = eprosima::fastrtps::Duration_t(0, 0);
  if (qos.depth == 0) {
    times.heartbeatPeriod = eprosima::fastrtps::Duration_t(0, 20'000'000);
    writer_qos.reliability().max_blocking_time = eprosima::fastrtps::Duration_t(1, 0);
  }
  state_->writer = owner.publisher->create_datawriter(
      owner.topic(topic, type), writer_qos, state_.get(), dds::StatusMask::publication_matched());
  if (state_->writer == nullptr) refuse(owner, topic, qos, true);
  require_granted(qos, granted_qos(), state_->topic);
  owner.add_endpoint({guid(), true, wire_topic(topic), wire_type(type), qos.reliable,
                      qos.transient_local, 0.0, type_hash});
}

RawWriter::~RawWriter() = default;

RawWriter::State::~State() {
  if (writer == nullptr) return;
  matches.stop_notifying();
  Participant::State& owner = participant->state();
  owner.remove_endpoint(to_guid(writer->guid()));
  writer->set_listener(nullptr);
  // Fast DDS 2.9 gives back, without a lock, the changes that are left, and a heartbeat that comes
  // just then runs for ever. Mended in 2.6.7, 2.10.3, 2.11.3, 2.12.2 and 2.13
  // (https://github.com/eProsima/Fast-DDS/pull/4076).
  writer->clear_history(nullptr);
  owner.publisher->delete_datawriter(writer);
}

const std::string& RawWriter::topic() const { return state_->topic; }

std::int64_t RawWriter::publish(const std::vector<std::uint8_t>& cdr,
                                const SampleIdentity& related) {
  if (cdr.size() < 4) {
    throw InputError(state_->topic,
                     "a message of " + std::to_string(cdr.size()) +
                         " bytes is shorter than the header of every message",
                     "leave it out");
  }
  // The sample type only reads, but the interface takes a mutable pointer.
  auto* sample = const_cast<std::vector<std::uint8_t>*>(&cdr);
  const auto deadline = std::chrono::steady_clock::now() + kPublishTimeout;
  // A keep-all history that is just full makes one write fail before its time; a second succeeds.
  rtps::WriteParams parameters;
  if (related.sequence_number != 0 || related.writer != Guid{}) {
    parameters.related_sample_identity(to_wire(related));
  }
  for (int tries = 1; !state_->writer->write(sample, parameters); ++tries) {
    // Who fails again and again may fail at once each time: no core is to be spent on it.
    if (tries > 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (std::chrono::steady_clock::now() > deadline) {
      throw OutputError(state_->topic, "a message cannot be delivered",
                        "see whether a reader of the topic hangs");
    }
  }
  ++state_->count;
  return from_wire(parameters.sample_identity()).sequence_number;
}

void RawWriter::send_heartbeat() { state_->writer->assert_liveliness(); }

std::uint64_t RawWriter::count() const { return state_->count; }
Guid RawWriter::guid() const { return to_guid(state_->writer->guid()); }
int RawWriter::matched() const { return state_->matches.get(); }
bool RawWriter::is_matched_with(const Guid& participant) const {
  return state_->matches.has(participant);
}
bool RawWriter::wait_for_readers(int readers, std::chrono::milliseconds timeout) const {
  return state_->matches.wait(readers, timeout);
}
QosProfile RawWriter::granted_qos() const {
  return profile_of(state_->profile, state_->writer->get_qos());
}

struct RawReader::State : dds::DataReaderListener {
  State(Callback message_callback, std::function<void()> on_match)
      : callback(std::move(message_callback)), matches(std::move(on_match)) {}
  ~State() override;
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void on_data_available(dds::DataReader* from) override {
    Caught& caught = participant->state().caught;
    caught.run([&] {
      const std::lock_guard lock(mutex);
      dds::SampleInfo info;
      RawMessage message;
      while (callback && from->take_next_sample(&message.cdr, &info) ==
                             eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
        if (!info.valid_data) continue;
        message.identity = from_wire(info.sample_identity);
        message.related = from_wire(info.related_sample_identity);
        message.source_stamp_ns = info.source_timestamp.to_ns();
        // Each by itself: one bad message must not hold up those behind it.
        caught.run([&] { callback(std::move(message)); });
        message = RawMessage();
      }
    });
  }
  void on_subscription_matched(dds::DataReader* /*from*/,
                               const dds::SubscriptionMatchedStatus& status) override {
    participant->state().caught.run([&] {
      matches.set(status.current_count, guid_of(status.last_publication_handle),
                  status.current_count_change > 0);
    });
  }

  std::shared_ptr<Participant> participant;
  std::string topic;
  std::string profile;
  dds::DataReader* reader = nullptr;
  std::mutex mutex;
  Callback callback;
  MatchCount matches;
};

RawReader::RawReader(std::shared_ptr<Participant> participant, TopicName topic,
                     const std::string& type, const QosProfile& qos, Callback callback,
                     std::function<void()> on_match)
    : state_(std::make_unique<State>(std::move(callback), std::move(on_match))) {
  state_->participant = std::move(participant);
  state_->topic = topic.full;
  state_->profile = qos.name;
  Participant::State& owner = state_->participant->state();
  dds::DataReaderQos reader_qos = dds::DATAREADER_QOS_DEFAULT;
  const std::string type_hash = hash_of(topic, type);
  apply_profile(qos, type_hash, reader_qos);
  auto& times = reader_qos.reliable_reader_qos().times;
  // 70 ms by default: for so long a message waits that was sent before this reader knew its writer,
  // as the first request of a new client often is.
  times.initialAcknackDelay = eprosima::fastrtps::Duration_t(0, 2'000'000);
  if (qos.depth == 0) {
    // 5 ms by default, which is what bounds a reliable reader's rate.
    times.heartbeatResponseDelay = eprosima::fastrtps::Duration_t(0, 0);
  }
  state_->reader = owner.subscriber->create_datareader(
      owner.topic(topic, type), reader_qos, state_.get(),
      dds::StatusMask::data_available() << dds::StatusMask::subscription_matched());
  if (state_->reader == nullptr) refuse(owner, topic, qos, false);
  require_granted(qos, granted_qos(), state_->topic);
  owner.add_endpoint({guid(), false, wire_topic(topic), wire_type(type), qos.reliable,
                      qos.transient_local, 0.0, type_hash});
}

RawReader::~RawReader() = default;

RawReader::State::~State() {
  if (reader == nullptr) return;
  Participant::State& owner = participant->state();
  owner.remove_endpoint(to_guid(reader->guid()));
  matches.stop_notifying();
  {
    const std::lock_guard lock(mutex);
    callback = nullptr;
  }
  reader->set_listener(nullptr);
  owner.subscriber->delete_datareader(reader);
}

const std::string& RawReader::topic() const { return state_->topic; }
Guid RawReader::guid() const { return to_guid(state_->reader->guid()); }
int RawReader::matched() const { return state_->matches.get(); }
bool RawReader::wait_for_writers(int writers, std::chrono::milliseconds timeout) const {
  return state_->matches.wait(writers, timeout);
}
QosProfile RawReader::granted_qos() const {
  return profile_of(state_->profile, state_->reader->get_qos());
}

}  // namespace strata::bus
