// SPDX-License-Identifier: Apache-2.0
#include "tests/across/every_component/fence.hpp"

#include <chrono>
#include <cstring>
#include <thread>
#include <vector>

#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <gtest/gtest.h>

namespace strata::test {
namespace {

constexpr const char* kType = "std_msgs/msg/String";
constexpr auto kPatience = std::chrono::minutes(1);

}  // namespace

void send_over_udp_within_the_process() {
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
}

Fence::Fence(const std::shared_ptr<bus::Participant>& from,
             const std::shared_ptr<bus::Participant>& to, const std::string& topic) {
  const bus::QosProfile qos = bus::qos_profile("default");
  reader_ = std::make_unique<bus::RawReader>(
      to, topic, kType, qos,
      [this, writes = std::this_thread::get_id()](const bus::RawMessage& message) {
        std::uint32_t number = 0;
        std::memcpy(&number, message.cdr.data() + 4, sizeof number);
        const std::lock_guard lock(mutex_);
        arrived_ = number;
        is_on_writers_thread_ = std::this_thread::get_id() == writes;
        came_.notify_one();
      });
  writer_ = std::make_unique<bus::RawWriter>(from, topic, kType, qos);
  EXPECT_TRUE(writer_->wait_for_readers(1, kPatience));
}

void Fence::pass() {
  std::vector<std::uint8_t> message = {0, 1, 0, 0, 0, 0, 0, 0};
  ++sent_;
  std::memcpy(message.data() + 4, &sent_, sizeof sent_);
  writer_->publish(message);
  std::unique_lock lock(mutex_);
  EXPECT_TRUE(came_.wait_for(lock, kPatience, [&] { return arrived_ == sent_; }));
  EXPECT_FALSE(is_on_writers_thread_) << "delivered within the process";
}

}  // namespace strata::test
