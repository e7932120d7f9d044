// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/message_ring.hpp"

#include <algorithm>

namespace strata::incident_recorder {
namespace {

/// Writers of latched topics may come and go for as long as the robot runs.
constexpr std::size_t kMaxLatched = 1000;

std::size_t bytes_of(const KeptMessage& message) {
  return sizeof(KeptMessage) + message.cdr.capacity();
}

bool came_earlier(const KeptMessagePtr& a, const KeptMessagePtr& b) { return a->came < b->came; }

}  // namespace

MessageRing::MessageRing(std::chrono::duration<double> span, std::size_t max_bytes)
    : span_(span), max_bytes_(max_bytes) {}

void MessageRing::add(KeptMessagePtr message) {
  bytes_ += bytes_of(*message);
  recent_.push_back(std::move(message));
  fit();
}

void MessageRing::forget(Clock::time_point now) {
  while (!recent_.empty() && now - recent_.front()->came > span_) forget_first();
}

void MessageRing::forget_first() {
  KeptMessagePtr first = std::move(recent_.front());
  recent_.pop_front();
  if (!first->topic->is_latched) {
    bytes_ -= bytes_of(*first);
    return;
  }
  KeptMessagePtr& place = latched_[{first->topic->name, first->writer}];
  if (place) bytes_ -= bytes_of(*place);
  place = std::move(first);
}

void MessageRing::fit() {
  const auto forget_latched = [this] {
    const auto oldest = std::min_element(
        latched_.begin(), latched_.end(),
        [](const auto& a, const auto& b) { return came_earlier(a.second, b.second); });
    bytes_ -= bytes_of(*oldest->second);
    latched_.erase(oldest);
  };
  while (bytes_ > max_bytes_ && recent_.size() > 1) {
    forget_first();
    ++gone_early_;
  }
  while (latched_.size() > kMaxLatched || (bytes_ > max_bytes_ && !latched_.empty())) {
    forget_latched();
  }
}

std::vector<KeptMessagePtr> MessageRing::messages() const {
  std::vector<KeptMessagePtr> all;
  all.reserve(latched_.size() + recent_.size());
  for (const auto& [key, message] : latched_) all.push_back(message);
  std::sort(all.begin(), all.end(), came_earlier);
  Stamp begin{0};
  if (!recent_.empty()) {
    begin = (*std::min_element(recent_.begin(), recent_.end(), [](const auto& a, const auto& b) {
              return a->stamp < b->stamp;
            }))->stamp;
  }
  for (KeptMessagePtr& message : all) {
    if (begin <= message->stamp) continue;
    auto moved = std::make_shared<KeptMessage>(*message);
    moved->stamp = begin;
    message = std::move(moved);
  }
  all.insert(all.end(), recent_.begin(), recent_.end());
  return all;
}

}  // namespace strata::incident_recorder
