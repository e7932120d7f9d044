// SPDX-License-Identifier: Apache-2.0
/// The part of a component that works step by step, as the coordinator asks.
#include <algorithm>

#include "components/runtime/component_subscription.hpp"
#include "components/runtime/topic_count.hpp"

namespace strata::runtime {
namespace {

using strata_msgs::msg::Ack;
using strata_msgs::msg::Step;
using strata_msgs::msg::TopicCount;

}  // namespace

void Component::join_lockstep() {
  const bus::QosProfile qos = bus::qos_profile("lossless");
  ack_writer_ = std::make_unique<bus::RawWriter>(context_.participant, kAckTopic,
                                                 bus::MessageType<Ack>::name, qos);
  step_reader_ = std::make_unique<bus::Reader<Step>>(context_.participant, kStepTopic, qos,
                                                     [this](const Step& step) {
                                                       if (step.target() != full_name_) return;
                                                       context_.mailbox->post([this, step] {
                                                         guarded([&] {
                                                           step_ = step;
                                                           try_step();
                                                         });
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
  } catch (...) {
    error = "an exception of unknown type";
  }
  if (!error.empty()) {
    ++failed_;
    last_error_ = error;
  }
  acknowledge(step, error);
  if (diagnostics_ && diagnostics_->is_due()) diagnose();
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
      on_activate();
      state_ = LifecycleState::kActive;
      break;
    case strata_msgs::msg::STEP_CYCLE:
      work_off();
      break;
    case strata_msgs::msg::STEP_FINISH:
      work_off();
      if (finished_) break;
      on_finish(context_.out_folder.empty() ? std::filesystem::path(step.out_dir())
                                            : step.out_dir() / context_.out_folder);
      finished_ = learns();
      break;
  }
}

void Component::work_off() {
  for (const auto& subscription : subscriptions_) {
    std::deque<Subscription::Waiting> batch;
    {
      const std::lock_guard lock(subscription->mutex);
      batch.swap(subscription->waiting);
      subscription->waiting_bytes = 0;
    }
    if (finished_) continue;
    for (const Subscription::Waiting& waiting : batch) {
      subscription->callback(waiting.message);
      ++processed_;
    }
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
