// SPDX-License-Identifier: Apache-2.0
/// The part of a component that takes messages from others and gives them to the callbacks.
#include <algorithm>
#include <chrono>
#include <utility>

#include "components/runtime/component_subscription.hpp"

namespace strata::runtime {
namespace {

/// Live: as many bytes of one topic may wait for a component that does not keep up.
constexpr std::size_t kMaxWaitingBytes = 256U << 20U;

double seconds_of(std::chrono::duration<double> time) { return time.count(); }

/// For one more element, so that adding it cannot fail.
template <typename T>
void make_room(std::vector<T>& list) {
  if (list.size() == list.capacity()) list.reserve(2 * list.size() + 4);
}

}  // namespace

void Component::subscribe_raw(const std::string& full_topic, const std::string& type,
                              const bus::QosProfile& qos,
                              std::function<void(const bus::RawMessage&)> callback,
                              Reception reception) {
  const auto subscription = std::make_shared<Subscription>();
  subscription->topic = full_topic;
  const bool is_read = std::any_of(subscriptions_.begin(), subscriptions_.end(),
                                   [&](const auto& other) { return other->topic == full_topic; });
  subscription->label = is_read ? full_topic + " (of others)" : full_topic;
  TopicUse use{full_topic, type, qos, false};
  subscription->callback = std::move(callback);
  const bus::QosProfile used = lockstep() ? qos.lossless() : qos;
  const int depth = used.depth > 0 ? std::max(used.depth, reception.min_waiting) : used.depth;
  subscription->depth = static_cast<std::size_t>(depth);
  subscription->latched = used.transient_local;
  subscription->until_active = used.transient_local || reception.until_active;
  subscription->at_ticks = reception.at_ticks;
  subscription->latched_depth = static_cast<std::size_t>(reception.latched_depth);
  // The reader is the subscription's, so its callback holds it weakly.
  const std::weak_ptr<Subscription> weak = subscription;
  const auto on_message = [this, weak](bus::RawMessage message) {
    const auto held = weak.lock();
    if (!held || !keep(*held, std::move(message))) return;
    if (lockstep()) {
      context_.mailbox->post([this] { guarded([&] { try_step(); }); });
    } else if (!held->at_ticks) {
      context_.mailbox->post([this, held] { take_live(*held); });
    }
  };
  const auto on_match = [this] {
    context_.mailbox->post([this] { guarded([&] { try_step(); }); });
  };
  make_room(topics_);
  make_room(subscriptions_);
  subscription->reader = std::make_unique<bus::RawReader>(context_.participant, full_topic, type,
                                                          used, on_message, on_match);
  topics_.push_back(std::move(use));
  subscriptions_.push_back(subscription);
}

void Component::unsubscribe(const std::string& full_topic) {
  std::erase_if(subscriptions_, [&](const std::shared_ptr<Subscription>& subscription) {
    if (subscription->topic != full_topic) return false;
    subscription->reader.reset();
    // Tasks that hold it find nothing.
    const std::lock_guard lock(subscription->mutex);
    subscription->waiting.clear();
    subscription->waiting_bytes = 0;
    return true;
  });
  std::erase_if(topics_,
                [&](const TopicUse& use) { return use.topic == full_topic && !use.writes; });
}

bool Component::keep(Subscription& subscription, bus::RawMessage message) {
  const std::lock_guard lock(subscription.mutex);
  ++subscription.received;
  ++received_;
  subscription.sequences.take(message.identity);
  subscription.waiting_bytes += message.cdr.size();
  subscription.waiting.push_back({std::move(message), std::chrono::steady_clock::now()});
  if (lockstep()) return true;
  if (!is_active() && subscription.latched && subscription.latched_depth > 0) {
    ignored_ += subscription.drop_replaced();
  }
  const auto is_too_much = [&] {
    const std::size_t count = subscription.waiting.size();
    return (subscription.depth > 0 && count > subscription.depth) ||
           (count > 1 && subscription.waiting_bytes > kMaxWaitingBytes);
  };
  bool has_dropped = false;
  while (is_too_much()) {
    subscription.waiting_bytes -= subscription.waiting.front().message.cdr.size();
    subscription.waiting.pop_front();
    ++dropped_;
    has_dropped = true;
  }
  return !has_dropped;  // the task of the dropped one takes this one
}

std::shared_ptr<bus::RawWriter> Component::advertise_raw(const std::string& full_topic,
                                                         const std::string& type,
                                                         const bus::QosProfile& qos) {
  TopicUse use{full_topic, type, qos, true};
  const auto on_match = [this] {
    context_.mailbox->post([this] { guarded([&] { try_step(); }); });
  };
  make_room(topics_);
  make_room(writers_);
  auto writer = std::make_shared<bus::RawWriter>(context_.participant, full_topic, type,
                                                 lockstep() ? qos.lossless() : qos, on_match);
  topics_.push_back(std::move(use));
  writers_.push_back(writer);
  return writer;
}

bool Component::take_live(Subscription& subscription) {
  // Who publishes a latched message does it once: it must not be lost before we are active.
  if (!is_active() && subscription.until_active) return false;
  bus::RawMessage message;
  {
    const std::lock_guard lock(subscription.mutex);
    if (subscription.waiting.empty()) return false;
    message = std::move(subscription.waiting.front().message);
    subscription.waiting.pop_front();
    subscription.waiting_bytes -= message.cdr.size();
  }
  if (!is_active()) {
    ++ignored_;
    return true;
  }
  const std::uint64_t failed_before = failed_;
  const auto begin = std::chrono::steady_clock::now();
  guarded([&] { subscription.callback(message); });
  subscription.work_times.add(seconds_of(std::chrono::steady_clock::now() - begin));
  // A latched one may be as old as it likes.
  if (!subscription.latched && message.source_stamp_ns > 0) {
    const std::chrono::nanoseconds written(message.source_stamp_ns);
    subscription.latencies.add(
        seconds_of(std::chrono::system_clock::now().time_since_epoch() - written));
  }
  ++(failed_ == failed_before ? processed_ : skipped_);
  return true;
}

void Component::take_waiting() {
  // By number: a callback may subscribe.
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    const std::shared_ptr<Subscription> subscription = subscriptions_[i];
    if (!subscription->at_ticks) continue;
    // No more than are there: others may come as fast as these are taken.
    for (std::size_t left = subscription->count_waiting(); left > 0; --left) {
      if (!take_live(*subscription)) break;
    }
  }
}

MessageCounts Component::counts() const {
  MessageCounts counts;
  // In this order: what is received meanwhile is not yet done.
  counts.processed = processed_;
  counts.skipped = skipped_;
  counts.dropped = dropped_;
  counts.ignored = ignored_;
  counts.received = received_;
  return counts;
}

}  // namespace strata::runtime
