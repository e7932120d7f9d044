// SPDX-License-Identifier: Apache-2.0
/// strata::TimescaleMemory over DDS, and the robots that feed it.
#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "components/convert/scan_messages.hpp"
#include "components/timescale_memory/register.hpp"
#include "memory/store/store.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/memory/nodes/room_world.hpp"
#include "tests/support/test_data.hpp"

namespace strata::timescale_memory {

using memory::TimescaleMemory;
using memory::test_world::observe;
using strata_msgs::msg::LabeledScan;

/// A memory in a process of its own.
class LiveMemory {
 public:
  explicit LiveMemory(const std::string& parameters)
      : participant_(test::make_participant()), watch_(participant_) {
    register_component(registry_);
    host_ = test::make_host(
        "{type: strata::TimescaleMemory, name: memory, parameters: {" + parameters + "}}",
        registry_, test::make_participant());
    host_->activate();
  }
  /// The first that says so.
  [[nodiscard]] test::DiagnosticStatus status(const std::string& key, const std::string& value) {
    return watch_.wait_for(*host_,
                           [&](const auto& now) { return test::value_of(now, key) == value; });
  }
  [[nodiscard]] bool has_received(const std::string& topic, int count) {
    const std::string key = "received " + topic;
    const auto status = watch_.wait_for(
        *host_, [&](const auto& now) { return test::value_of(now, key) == std::to_string(count); });
    return test::value_of(status, key) == std::to_string(count);
  }

 private:
  std::shared_ptr<bus::Participant> participant_;
  test::StatusWatch watch_;
  runtime::Registry registry_;
  std::unique_ptr<runtime::Host> host_;
};

class Robot {
 public:
  explicit Robot(const std::string& topic)
      : scans_(test::make_participant(), topic, bus::qos_profile("lossless")) {
    EXPECT_TRUE(scans_.raw().wait_for_readers(1, std::chrono::seconds(20)));
  }
  void publish(const PosedScan& scan) { scans_.publish(convert::to_message(scan, "map", "laser")); }

 private:
  bus::Writer<LabeledScan> scans_;
};

class LiveMemoryTest : public testing::Test {
 protected:
  [[nodiscard]] std::string path() const { return (directory_.path() / "strata.db").string(); }
  [[nodiscard]] TimescaleMemory stored() const { return memory::Store(path()).load_timescale(); }

 private:
  test::TemporaryDirectory directory_;
};

}  // namespace strata::timescale_memory
