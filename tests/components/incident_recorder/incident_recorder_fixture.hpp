// SPDX-License-Identifier: Apache-2.0
/// A robot that publishes scans and how it is, and a recorder of its incidents.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/convert/cdr.hpp"
#include "components/incident_recorder/incident_folder.hpp"
#include "components/incident_recorder/register.hpp"
#include "tests/components/incident_recorder/numbered_scans.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace strata::incident_recorder {

using diagnostic_msgs::msg::DiagnosticArray;
using sensor_msgs::msg::LaserScan;

constexpr auto kPatience = std::chrono::seconds(20);

inline DiagnosticArray told(const std::string& verdict) {
  diagnostic_msgs::msg::KeyValue entry;
  entry.key("verdict");
  entry.value(verdict);
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.name("localizer: health");
  status.values().push_back(entry);
  DiagnosticArray message;
  message.status().push_back(status);
  return message;
}

class IncidentRecorderTest : public testing::Test {
 protected:
  /// entry: what else the composition says of it.
  void start(const std::string& parameters,
             const std::shared_ptr<bus::Participant>& participant = test::make_participant(),
             const std::string& entry = "") {
    runtime::Registry registry;
    register_component(registry);
    host_ =
        test::make_host("{type: strata::IncidentRecorder, name: incidents, parameters: {out: '" +
                            out().string() + "'" + parameters + "}" + entry + "}",
                        registry, participant);
    host_->activate();
    const auto is_read = [](const bus::RawWriter& writer) {
      return writer.wait_for_readers(1, std::chrono::milliseconds(0));
    };
    // Topics are found as they are discovered, at ticks.
    ASSERT_TRUE(test::comes_true([&] {
      host_->tick();
      return is_read(scans_.raw()) && is_read(latched_.raw()) && is_read(diagnostics_.raw());
    }));
    tell("good");
  }
  void tell(const std::string& verdict) { diagnostics_.publish(told(verdict)); }
  /// Ticks until so many incidents are on the disk, whole.
  std::vector<IncidentRecord> wait_for(std::size_t count) {
    std::vector<IncidentRecord> records;
    EXPECT_TRUE(test::comes_true([&] {
      host_->tick();
      records = read_records(out());
      const auto is_complete = [](const IncidentRecord& record) { return record.is_complete; };
      return records.size() >= count && std::all_of(records.begin(), records.end(), is_complete);
    }));
    return records;
  }
  /// Until everything that was published has been worked on. Within a process Fast DDS hands a
  /// message over on the thread that writes it, so all of them have come.
  void settle() {
    const auto counts = [this] { return host_->components().front()->counts(); };
    const std::uint64_t received = counts().received;
    EXPECT_TRUE(test::comes_true([&] {
      host_->tick();
      return counts().done() >= received;
    }));
  }
  std_srvs::srv::Trigger_Response ask() {
    const auto response = bus::call_service<bus::srv::Trigger>(
        participant_, "/incidents/keep_incident", {}, kPatience);
    EXPECT_TRUE(response.has_value());
    return response.value_or(std_srvs::srv::Trigger_Response());
  }
  [[nodiscard]] std::filesystem::path out() const { return folder_.path() / "incidents"; }

  test::TemporaryDirectory folder_;
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  bus::Writer<LaserScan> scans_{participant_, "/scan", bus::qos_profile("default")};
  bus::Writer<LaserScan> latched_{participant_, "/latched", bus::qos_profile("latched")};
  bus::Writer<DiagnosticArray> diagnostics_{participant_, "/diagnostics",
                                            bus::qos_profile("default")};
  std::unique_ptr<runtime::Host> host_;
};

}  // namespace strata::incident_recorder
