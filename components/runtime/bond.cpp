// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/bond.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "components/convert/geometry_messages.hpp"

namespace strata::runtime {
namespace {

/// What we promise: as nav2's nodes do.
constexpr float kTimeoutS = 4.0F;
constexpr float kPeriodS = 0.1F;
/// How long a manager is believed that states more, and one that states nothing sensible.
constexpr double kLongestTimeoutS = 60.0;
constexpr double kUnstatedTimeoutS = 4.0;

}  // namespace

Bond::Bond(const std::shared_ptr<bus::Participant>& participant, const std::string& topic,
           std::string id)
    : id_(std::move(id)),
      writer_(participant, topic, bus::qos_profile("default")),
      // As unique on the domain as the UUID that others take.
      instance_id_(bus::guid_text(writer_.raw().guid())),
      reader_(participant, topic, bus::qos_profile("default"),
              [this](const bond::msg::Status& status) { hear(status); }) {}

void Bond::hear(const bond::msg::Status& status) {
  if (status.id() != id_) return;
  const std::lock_guard lock(mutex_);
  if (status.instance_id() == instance_id_) return;
  if (!status.active()) {
    must_answer_end_ = heard_until_.has_value();
    heard_until_.reset();
    return;
  }
  const double stated_s = static_cast<double>(status.heartbeat_timeout());
  const bool is_sensible = std::isfinite(stated_s) && stated_s > 0.0;
  const double timeout_s = is_sensible ? std::min(stated_s, kLongestTimeoutS) : kUnstatedTimeoutS;
  heard_until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                    std::chrono::duration<double>(timeout_s));
}

void Bond::tick() {
  bool is_heard = false;
  bool must_end = false;
  {
    const std::lock_guard lock(mutex_);
    if (heard_until_ && Clock::now() > *heard_until_) heard_until_.reset();
    is_heard = heard_until_.has_value();
    must_end = std::exchange(must_answer_end_, false);
  }
  if (is_heard) {
    send(true);
  } else if (must_end) {
    send(false);
  }
}

void Bond::end() {
  {
    const std::lock_guard lock(mutex_);
    must_answer_end_ = false;
    if (!heard_until_) return;
    heard_until_.reset();
  }
  send(false);
}

bool Bond::is_formed() const {
  const std::lock_guard lock(mutex_);
  return heard_until_.has_value();
}

void Bond::send(bool active) {
  bond::msg::Status status;
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  status.header().stamp(convert::to_message(
      Stamp{std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count()}));
  status.id(id_);
  status.instance_id(instance_id_);
  status.active(active);
  status.heartbeat_timeout(kTimeoutS);
  status.heartbeat_period(kPeriodS);
  writer_.publish(status);
}

}  // namespace strata::runtime
