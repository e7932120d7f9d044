// SPDX-License-Identifier: Apache-2.0
/// Incidents of a live robot: what is kept, when, and what disks and kills do to it.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/convert/cdr.hpp"
#include "components/incident_recorder/incident.hpp"
#include "components/incident_recorder/register.hpp"
#include "components/log/bag.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::incident_recorder {
namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using sensor_msgs::msg::LaserScan;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr auto kPatience = std::chrono::seconds(20);

LaserScan numbered(int number) {
  LaserScan scan;
  scan.header().stamp().sec(number);
  scan.ranges().assign(100, static_cast<float>(number));
  return scan;
}

DiagnosticArray told(const std::string& verdict) {
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

/// Numbers of the scans of a bag, by topic.
std::map<std::string, std::vector<int>> scans_in(const std::filesystem::path& folder) {
  const auto reader = log::BagReader::open(folder);
  std::map<std::string, std::vector<int>> numbers;
  for (log::BagMessage message; reader->next(message);) {
    const log::BagTopic& topic = reader->topics()[message.topic];
    if (topic.type != "sensor_msgs/msg/LaserScan") continue;
    const auto scan = convert::from_cdr<LaserScan>(message.data, topic.name);
    numbers[topic.name].push_back(scan.header().stamp().sec());
  }
  return numbers;
}

class IncidentRecorderTest : public testing::Test {
 protected:
  void start(const std::string& parameters) {
    runtime::Registry registry;
    register_component(registry);
    host_ =
        test::make_host("{type: strata::IncidentRecorder, name: incidents, parameters: {out: '" +
                            out().string() + "'" + parameters + "}}",
                        registry, test::make_participant());
    host_->activate();
    const auto until = std::chrono::steady_clock::now() + kPatience;
    const auto is_read = [](const bus::RawWriter& writer) {
      return writer.wait_for_readers(1, std::chrono::milliseconds(5));
    };
    // Topics are found as they are discovered, at ticks.
    while (!is_read(scans_.raw()) || !is_read(latched_.raw()) || !is_read(diagnostics_.raw())) {
      ASSERT_LT(std::chrono::steady_clock::now(), until);
      host_->tick();
    }
    tell("good");
  }
  void tell(const std::string& verdict) { diagnostics_.publish(told(verdict)); }
  /// Ticks until so many incidents are on the disk.
  std::vector<IncidentRecord> wait_for(std::size_t count) {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    for (;;) {
      host_->tick();
      auto records = read_records(out());
      const auto is_complete = [](const IncidentRecord& record) { return record.is_complete; };
      if (records.size() >= count && std::all_of(records.begin(), records.end(), is_complete)) {
        return records;
      }
      if (std::chrono::steady_clock::now() > until) return records;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  /// Until everything that was published has been worked on.
  void settle() {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    const auto counts = [this] { return host_->components().front()->counts(); };
    while (counts().done() < published_ && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  [[nodiscard]] std::filesystem::path out() const { return folder_.path() / "incidents"; }

  test::TemporaryDirectory folder_;
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  bus::Writer<LaserScan> scans_{participant_, "/scan", bus::qos_profile("default")};
  bus::Writer<LaserScan> latched_{participant_, "/latched", bus::qos_profile("latched")};
  bus::Writer<DiagnosticArray> diagnostics_{participant_, "/diagnostics",
                                            bus::qos_profile("default")};
  std::unique_ptr<runtime::Host> host_;
  std::uint64_t published_ = 0;
};

TEST_F(IncidentRecorderTest, KeepsWhatCameBeforeWhatHoldsAndWhatComesAfter) {
  latched_.publish(numbered(1000));
  start(", before_s: 3.0, after_s: 3.0");
  std::this_thread::sleep_for(std::chrono::milliseconds(3200));
  for (int i = 0; i < 50; ++i) scans_.publish(numbered(i));
  published_ = 52;
  settle();
  tell("lost");
  published_ = 53;
  settle();
  for (int i = 50; i < 80; ++i) scans_.publish(numbered(i));
  const auto records = wait_for(1);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_TRUE(records[0].is_complete);
  EXPECT_EQ(records[0].reasons[0].kind, "lost");
  EXPECT_EQ(records[0].lost, 0U);
  const auto scans = scans_in(records[0].folder);
  std::vector<int> all(80);
  for (int i = 0; i < 80; ++i) all[static_cast<std::size_t>(i)] = i;
  EXPECT_EQ(scans.at("/scan"), all);
  EXPECT_EQ(scans.at("/latched"), std::vector<int>{1000}) << "older than the span, but it holds";
  EXPECT_THAT(host_->take_errors(), IsEmpty());
}

TEST_F(IncidentRecorderTest, IsAskedForByTheService) {
  start(", after_s: 0.0");
  scans_.publish(numbered(7));
  published_ = 2;
  settle();
  const auto response =
      bus::call_service<bus::srv::Trigger>(participant_, "/incidents/keep_incident", {}, kPatience);
  ASSERT_TRUE(response.has_value());
  EXPECT_TRUE(response->success());
  const auto records = wait_for(1);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].reasons[0].kind, "asked");
  EXPECT_EQ(scans_in(records[0].folder).at("/scan"), std::vector<int>{7});
}

TEST_F(IncidentRecorderTest, WhatGoesWrongMeanwhileIsPartOfItAndNothingBeginsInItsRest) {
  start(", after_s: 0.3, rest_s: 1000.0");
  for (const char* verdict : {"lost", "good", "lost", "good"}) tell(verdict);
  auto records = wait_for(1);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_THAT(records[0].reasons, SizeIs(2));
  tell("lost");
  published_ = 6;
  settle();
  records = wait_for(1);
  EXPECT_THAT(records, SizeIs(1)) << "its rest lasts";
}

TEST_F(IncidentRecorderTest, RemovesTheOldestWhereTheDiskIsTakenUp) {
  start(", after_s: 0.0, rest_s: 0.0, disk_mb: 1.0, before_s: 0.0");
  IncidentRecord old;
  old.folder = out() / "old";
  old.reasons = {{"lost", "localizer: health", "lost"}};
  old.is_complete = true;
  std::filesystem::create_directories(old.folder);
  std::ofstream(old.folder / "bag_0.mcap") << std::string(1'500'000, 'x');
  write_record(old);
  tell("lost");
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (std::filesystem::exists(old.folder) && std::chrono::steady_clock::now() < until) {
    host_->tick();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_FALSE(std::filesystem::exists(old.folder));
  EXPECT_THAT(wait_for(1), SizeIs(1));
}

TEST_F(IncidentRecorderTest, DeactivatedMeanwhileItCompletesWhatItHas) {
  start(", after_s: 1000.0");
  scans_.publish(numbered(7));
  tell("lost");
  published_ = 3;
  settle();
  host_->stop();
  const auto records = read_records(out());
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_TRUE(records[0].is_complete);
  EXPECT_EQ(scans_in(records[0].folder).at("/scan"), std::vector<int>{7});
}

TEST_F(IncidentRecorderTest, OnAFullDiskGoesOnAndSaysSo) {
  start(", after_s: 0.0, rest_s: 0.0");
  {
    const test::FullDisk full;
    tell("lost");
    published_ = 2;
    settle();
    const auto until = std::chrono::steady_clock::now() + kPatience;
    std::vector<std::string> errors;
    while (errors.empty() && std::chrono::steady_clock::now() < until) {
      host_->tick();
      errors = host_->take_errors();
    }
    ASSERT_FALSE(errors.empty());
    EXPECT_THAT(errors[0], HasSubstr("incidents"));
  }
  tell("good");
  tell("lost");
  const auto until = std::chrono::steady_clock::now() + kPatience;
  std::size_t complete = 0;
  while (complete == 0 && std::chrono::steady_clock::now() < until) {
    host_->tick();
    for (const IncidentRecord& record : read_records(out())) complete += record.is_complete ? 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(complete, 1U) << "there is room again";
}

TEST(Incident, OfAProcessThatIsKilledIsListedAsCutOffAndCanBeRead) {
  const test::TemporaryDirectory folder;
  const auto topic =
      std::make_shared<const KeptTopic>(KeptTopic{"/scan", "sensor_msgs/msg/LaserScan", "", false});
  const auto message = [&](int number) {
    return std::make_shared<const KeptMessage>(KeptMessage{
        topic, {}, Stamp{number * 1'000'000'000LL}, {}, convert::to_cdr(numbered(number))});
  };
  IncidentRecord record;
  record.folder = folder.path() / "all" / "one";
  record.reasons = {{"lost", "localizer: health", "lost"}};
  std::filesystem::create_directories(folder.path() / "all");
  const IncidentPlan plan{folder.path() / "all", {}, 1'000'000'000, 1'000'000};
  Incident incident(plan, record, {message(1), message(2)});
  // As the disk is at the moment of a kill.
  const auto copy = folder.path() / "killed";
  const auto until = std::chrono::steady_clock::now() + kPatience;
  std::map<std::string, std::vector<int>> scans;
  while (scans["/scan"].size() < 2 && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::filesystem::remove_all(copy);
    std::filesystem::copy(folder.path() / "all", copy, std::filesystem::copy_options::recursive);
    try {
      scans = scans_in(copy / "one");
    } catch (const Error&) {  // nothing is in it yet
    }
  }
  EXPECT_EQ(scans["/scan"], (std::vector<int>{1, 2}));
  const auto records = read_records(copy);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_FALSE(records[0].is_complete);
}

}  // namespace
}  // namespace strata::incident_recorder
