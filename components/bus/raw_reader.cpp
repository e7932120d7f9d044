// SPDX-License-Identifier: Apache-2.0
#include <mutex>

#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "components/bus/endpoint_state.hpp"

namespace strata::bus {

struct RawReader::State : dds::DataReaderListener, EndpointState<dds::DataReader> {
  State(Callback message_callback, std::function<void()> on_match)
      : EndpointState(std::move(on_match)), callback(std::move(message_callback)) {}
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
    matched(status.current_count, status.last_publication_handle, status.current_count_change);
  }

  std::mutex mutex;
  Callback callback;
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
  state_->used = owner.topic(topic, type);
  state_->endpoint = owner.subscriber->create_datareader(
      state_->used, reader_qos, state_.get(),
      dds::StatusMask::data_available() << dds::StatusMask::subscription_matched());
  if (state_->endpoint == nullptr) refuse(owner, topic, qos, false);
  require_granted(qos, granted_qos(), state_->topic);
  owner.add_endpoint({guid(), false, wire_topic(topic), wire_type(type), qos.reliable,
                      qos.transient_local, 0.0, type_hash});
}

RawReader::~RawReader() = default;

RawReader::State::~State() {
  if (endpoint == nullptr) return;
  Participant::State& owner = participant->state();
  owner.remove_endpoint(to_guid(endpoint->guid()));
  matches.stop_notifying();
  {
    const std::lock_guard lock(mutex);
    callback = nullptr;
  }
  endpoint->set_listener(nullptr);
  owner.subscriber->delete_datareader(endpoint);
}

const std::string& RawReader::topic() const { return state_->topic; }
Guid RawReader::guid() const { return to_guid(state_->endpoint->guid()); }
int RawReader::matched() const { return state_->matches.get(); }
bool RawReader::wait_for_writers(int writers, std::chrono::milliseconds timeout) const {
  return state_->matches.wait(writers, timeout);
}
QosProfile RawReader::granted_qos() const {
  return profile_of(state_->profile, state_->endpoint->get_qos());
}

}  // namespace strata::bus
