// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <thread>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>

#include "components/bus/endpoint_state.hpp"
#include "core/base/error.hpp"

namespace strata::bus {
namespace {

constexpr auto kPublishTimeout = std::chrono::seconds(10);

}  // namespace

struct RawWriter::State : dds::DataWriterListener, EndpointState<dds::DataWriter> {
  using EndpointState::EndpointState;
  // Here and not in RawWriter: a constructor that throws must not leave the middleware our address.
  ~State() override;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  void on_publication_matched(dds::DataWriter* /*writer*/,
                              const dds::PublicationMatchedStatus& status) override {
    matched(status.current_count, status.last_subscription_handle, status.current_count_change);
  }
  std::atomic<std::uint64_t> count{0};
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
  state_->used = owner.topic(topic, type);
  state_->endpoint = owner.publisher->create_datawriter(state_->used, writer_qos, state_.get(),
                                                        dds::StatusMask::publication_matched());
  if (state_->endpoint == nullptr) refuse(owner, topic, qos, true);
  require_granted(qos, granted_qos(), state_->topic);
  owner.add_endpoint({guid(), true, wire_topic(topic), wire_type(type), qos.reliable,
                      qos.transient_local, 0.0, type_hash, qos.lifespan_s,
                      liveliness_of(writer_qos.liveliness().kind)});
}

RawWriter::~RawWriter() = default;

RawWriter::State::~State() {
  if (endpoint == nullptr) return;
  matches.stop_notifying();
  Participant::State& owner = participant->state();
  owner.remove_endpoint(to_guid(endpoint->guid()));
  endpoint->set_listener(nullptr);
  // Fast DDS 2.9 gives back, without a lock, the changes that are left, and a heartbeat that comes
  // just then runs for ever. Mended in 2.6.7, 2.10.3, 2.11.3, 2.12.2 and 2.13
  // (https://github.com/eProsima/Fast-DDS/pull/4076).
  endpoint->clear_history(nullptr);
  owner.publisher->delete_datawriter(endpoint);
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
  for (int tries = 1; !state_->endpoint->write(sample, parameters); ++tries) {
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

void RawWriter::send_heartbeat() { state_->endpoint->assert_liveliness(); }

std::uint64_t RawWriter::count() const { return state_->count; }
Guid RawWriter::guid() const { return to_guid(state_->endpoint->guid()); }
int RawWriter::matched() const { return state_->matches.get(); }
bool RawWriter::is_matched_with(const Guid& participant) const {
  return state_->matches.has(participant);
}
bool RawWriter::wait_for_readers(int readers, std::chrono::milliseconds timeout) const {
  return state_->matches.wait(readers, timeout);
}
QosProfile RawWriter::granted_qos() const {
  return profile_of(state_->profile, state_->endpoint->get_qos());
}

}  // namespace strata::bus
