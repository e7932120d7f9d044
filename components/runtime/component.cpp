// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/component.hpp"

#include <algorithm>

namespace strata::runtime {
namespace {

using strata_msgs::msg::Ack;
using strata_msgs::msg::Step;
using strata_msgs::msg::TopicCount;

TopicCount topic_count(const std::string& topic, std::uint64_t count) {
  TopicCount result;
  result.topic(topic);
  result.count(count);
  return result;
}

}  // namespace

Component::Component(ComponentContext context)
    : context_(std::move(context)),
      full_name_(bus::expand_name(context_.name, context_.node_namespace, context_.name)) {}

Component::~Component() = default;

void Component::configure() {
  context_.mailbox->call([this] {
    on_configure();
    if (lockstep()) join_lockstep();
  });
}

void Component::activate() {
  context_.mailbox->call([this] {
    if (active_) return;
    active_ = true;
    on_activate();
    if (lockstep()) return;
    for (const auto& subscription : subscriptions_) {
      while (take_live(*subscription)) {
      }
    }
  });
}

void Component::deactivate() {
  context_.mailbox->call([this] {
    if (!active_) return;
    active_ = false;
    on_deactivate();
  });
}

void Component::cleanup() {
  // Readers first, outside the mailbox: they wait for callbacks that may post to it.
  step_reader_.reset();
  context_.mailbox->call([this] { step_.reset(); });
  for (const auto& subscription : subscriptions_) subscription->reader.reset();
  context_.mailbox->call([this] {
    on_cleanup();
    writers_.clear();
    ack_writer_.reset();
  });
}

void Component::tick() {
  context_.mailbox->post([this] {
    if (!active_) return;
    try {
      on_tick();
    } catch (const std::exception& error) {
      if (context_.on_error) context_.on_error(full_name_ + ": " + error.what());
    }
  });
}

std::string Component::resolve(const std::string& topic) const {
  return bus::resolve_name(topic, context_.node_namespace, context_.name, context_.remappings);
}

std::string Component::parameters_place() const {
  return context_.place + " (parameters of " + context_.name + ")";
}

void Component::subscribe_raw(const std::string& full_topic, const std::string& type,
                              const bus::QosProfile& qos,
                              std::function<void(const bus::RawMessage&)> callback) {
  auto owned = std::make_unique<Subscription>();
  Subscription& subscription = *owned;
  subscriptions_.push_back(std::move(owned));
  subscription.topic = full_topic;
  subscription.callback = std::move(callback);
  const bus::QosProfile used = lockstep() ? qos.lossless() : qos;
  subscription.depth = static_cast<std::size_t>(used.depth);
  subscription.latched = used.transient_local;
  const auto on_message = [this, &subscription](bus::RawMessage message) {
    {
      const std::lock_guard lock(subscription.mutex);
      ++subscription.received;
      subscription.waiting.push_back(std::move(message));
      if (subscription.depth > 0 && subscription.waiting.size() > subscription.depth) {
        subscription.waiting.pop_front();
        ++dropped_;
        return;  // the task of the dropped one takes this one
      }
    }
    if (lockstep()) {
      context_.mailbox->post([this] { try_step(); });
    } else {
      context_.mailbox->post([this, &subscription] { take_live(subscription); });
    }
  };
  const auto on_match = [this] { context_.mailbox->post([this] { try_step(); }); };
  subscription.reader = std::make_unique<bus::RawReader>(context_.participant, full_topic, type,
                                                         used, on_message, on_match);
}

std::shared_ptr<bus::RawWriter> Component::advertise_raw(const std::string& full_topic,
                                                         const std::string& type,
                                                         const bus::QosProfile& qos) {
  const auto on_match = [this] { context_.mailbox->post([this] { try_step(); }); };
  auto writer = std::make_shared<bus::RawWriter>(context_.participant, full_topic, type,
                                                 lockstep() ? qos.lossless() : qos, on_match);
  writers_.push_back(writer);
  return writer;
}

bool Component::take_live(Subscription& subscription) {
  // Who publishes a latched message does it once: it must not be lost before we are active.
  if (!active_ && subscription.latched) return false;
  bus::RawMessage message;
  {
    const std::lock_guard lock(subscription.mutex);
    if (subscription.waiting.empty()) return false;
    message = std::move(subscription.waiting.front());
    subscription.waiting.pop_front();
  }
  if (!active_) return true;
  try {
    subscription.callback(message);
  } catch (const std::exception& error) {
    if (context_.on_error) context_.on_error(full_name_ + ": " + error.what());
  }
  return true;
}

void Component::join_lockstep() {
  const bus::QosProfile qos = bus::qos_profile("lossless");
  ack_writer_ = std::make_unique<bus::RawWriter>(context_.participant, kAckTopic,
                                                 bus::MessageType<Ack>::name, qos);
  step_reader_ = std::make_unique<bus::RawReader>(
      context_.participant, kStepTopic, bus::MessageType<Step>::name, qos,
      [this](const bus::RawMessage& message) {
        Step step = convert::from_cdr<Step>(message.cdr, kStepTopic);
        if (step.target() != full_name_) return;
        context_.mailbox->post([this, step = std::move(step)] {
          step_ = step;
          try_step();
        });
      });
}

void Component::try_step() {
  if (!step_ || !ack_writer_ || !ready_for(*step_)) return;
  const Step step = *step_;
  step_.reset();
  std::string error;
  try {
    perform(step);
  } catch (const std::exception& caught) {
    error = caught.what();
    if (error.empty()) error = "unknown error";
  }
  acknowledge(step, error);
}

bool Component::ready_for(const Step& step) {
  const auto has_come = [&](const TopicCount& expected) {
    return std::all_of(subscriptions_.begin(), subscriptions_.end(), [&](const auto& entry) {
      if (entry->topic != expected.topic()) return true;
      if (step.kind() == strata_msgs::msg::STEP_MATCH) {
        return entry->reader->matched() >= static_cast<int>(expected.count());
      }
      const std::lock_guard lock(entry->mutex);
      return entry->received >= expected.count();
    });
  };
  const auto is_read = [&](const TopicCount& expected) {
    return std::all_of(writers_.begin(), writers_.end(), [&](const auto& writer) {
      return writer->topic() != expected.topic() ||
             writer->matched() >= static_cast<int>(expected.count());
    });
  };
  return std::all_of(step.expected().begin(), step.expected().end(), has_come) &&
         std::all_of(step.readers().begin(), step.readers().end(), is_read);
}

void Component::perform(const Step& step) {
  switch (step.kind()) {
    case strata_msgs::msg::STEP_HELLO:
      break;
    case strata_msgs::msg::STEP_MATCH:
      active_ = true;
      on_activate();
      break;
    case strata_msgs::msg::STEP_CYCLE:
      work_off();
      break;
    case strata_msgs::msg::STEP_FINISH:
      work_off();
      on_finish(context_.out_folder.empty() ? std::filesystem::path(step.out_dir())
                                            : step.out_dir() / context_.out_folder);
      break;
  }
}

void Component::work_off() {
  for (const auto& subscription : subscriptions_) {
    std::deque<bus::RawMessage> batch;
    {
      const std::lock_guard lock(subscription->mutex);
      batch.swap(subscription->waiting);
    }
    for (const bus::RawMessage& message : batch) subscription->callback(message);
  }
}

void Component::acknowledge(const Step& step, const std::string& error) {
  Ack ack;
  ack.sequence_number(step.sequence_number());
  ack.component_name(full_name_);
  ack.ok(error.empty());
  ack.error(error);
  for (const auto& writer : writers_) {
    ack.published().push_back(topic_count(writer->topic(), writer->count()));
  }
  for (const auto& subscription : subscriptions_) {
    const std::lock_guard lock(subscription->mutex);
    ack.subscribed().push_back(topic_count(subscription->topic, subscription->received));
  }
  ack_writer_->publish(convert::to_cdr(ack));
}

}  // namespace strata::runtime
