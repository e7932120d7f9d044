// SPDX-License-Identifier: Apache-2.0
/// Incidents of a live robot: what is kept, when, and what disks and kills do to it.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/recorded_topic.hpp"
#include "tests/components/incident_recorder/incident_recorder_fixture.hpp"

namespace strata::incident_recorder {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST_F(IncidentRecorderTest, KeepsWhatCameBeforeAndWhatComesAfter) {
  start(", before_s: 1000.0, after_s: 1000.0");
  for (int i = 0; i < 50; ++i) scans_.publish(numbered(i));
  settle();
  tell("lost");
  settle();
  for (int i = 50; i < 80; ++i) scans_.publish(numbered(i));
  settle();
  host_->stop();
  const auto records = read_records(out());
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_TRUE(records[0].is_complete);
  EXPECT_EQ(records[0].reasons[0].kind, "lost");
  EXPECT_EQ(records[0].lost, 0U);
  std::vector<int> all(80);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(scans_in(records[0].folder).at("/scan"), all);
  EXPECT_THAT(host_->take_errors(), IsEmpty());
}

TEST_F(IncidentRecorderTest, KeepsWhatIsLatchedThoughItIsOlder) {
  latched_.publish(numbered(1000));
  start(", before_s: 0.0, after_s: 0.0");
  scans_.publish(numbered(7));
  settle();
  host_->tick();  // all of it is too old now
  ASSERT_TRUE(ask().success());
  const auto records = wait_for(1);
  ASSERT_THAT(records, SizeIs(1));
  const auto scans = scans_in(records[0].folder);
  EXPECT_EQ(scans.at("/latched"), std::vector<int>{1000});
  EXPECT_FALSE(scans.contains("/scan"));
}

TEST_F(IncidentRecorderTest, StampsWhatIsLatchedAndOldWithWhenItCame) {
  latched_.publish(numbered(1000));
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  const Stamp started = bus::wall_now();
  start(", before_s: 1000.0, after_s: 0.0");
  settle();
  ASSERT_TRUE(ask().success());
  const auto records = wait_for(1);
  ASSERT_THAT(records, SizeIs(1));
  const auto bag = log::BagReader::open(records[0].folder);
  log::BagMessage first;
  ASSERT_TRUE(bag->next(first));
  EXPECT_GE(first.stamp.ns, started.ns) << "a player must not wait for what comes next";
}

TEST_F(IncidentRecorderTest, BeginsWhereDiagnosticsHaveAnotherName) {
  bus::Writer<DiagnosticArray> own(participant_, "/robot1/diagnostics",
                                   bus::qos_profile("default"));
  start(", before_s: 1000.0, after_s: 0.0", test::make_participant(),
        ", namespace: /robot1, remappings: {/diagnostics: diagnostics}");
  tell("map_outdated");  // another robot's, on /diagnostics
  settle();
  EXPECT_THAT(read_records(out()), IsEmpty());
  for (const char* verdict : {"good", "lost"}) own.publish(told(verdict));
  const auto records = wait_for(1);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].reasons[0].kind, "lost");
}

TEST_F(IncidentRecorderTest, KeepsWritersThatComeLaterAndOfferLess) {
  start(", before_s: 1000.0, after_s: 0.0");
  bus::Writer<LaserScan> best_effort(participant_, "/scan", bus::qos_profile("sensor_data"));
  bus::Writer<LaserScan> no_more_latched(participant_, "/latched", bus::qos_profile("default"));
  ASSERT_TRUE(test::comes_true([&] {
    host_->tick();
    return best_effort.raw().matched() == 1 && no_more_latched.raw().matched() == 1;
  }));
  scans_.publish(numbered(1));
  best_effort.publish(numbered(2));
  latched_.publish(numbered(3));
  no_more_latched.publish(numbered(4));
  settle();
  ASSERT_TRUE(ask().success());
  const auto records = wait_for(1);
  ASSERT_THAT(records, SizeIs(1));
  const auto scans = scans_in(records[0].folder);
  EXPECT_THAT(scans.at("/scan"), testing::UnorderedElementsAre(1, 2)) << "each once";
  EXPECT_THAT(scans.at("/latched"), testing::UnorderedElementsAre(3, 4)) << "each once";
}

TEST_F(IncidentRecorderTest, KeepsTheMapsThatALocalizerUsesUnlessThatIsOff) {
  const std::filesystem::path maps = folder_.path() / "maps";
  std::filesystem::create_directories(maps);
  std::ofstream(maps / "map.yaml") << "resolution: 0.05";
  rcl_interfaces::msg::ParameterEvent point;
  rcl_interfaces::msg::Parameter named;
  named.name("maps");
  named.value().string_value(maps.string());
  point.new_parameters().push_back(named);
  bus::Writer<rcl_interfaces::msg::ParameterEvent> points(
      participant_, "/robot/localizer/_restore_point", bus::qos_profile("default"));
  for (const bool is_kept : {true, false}) {
    std::filesystem::remove_all(out());
    start(std::string(", after_s: 0.0, keep_maps: ") + (is_kept ? "true" : "false"));
    ASSERT_TRUE(test::comes_true([&] {
      host_->tick();
      return points.raw().wait_for_readers(1, std::chrono::milliseconds(0));
    }));
    const auto received = [this] { return host_->components().front()->counts().received; };
    const std::uint64_t before = received();
    points.publish(point);
    ASSERT_TRUE(test::comes_true([&] { return received() > before; }));
    ASSERT_TRUE(ask().success()) << "before the next tick";
    const auto records = wait_for(1);
    ASSERT_THAT(records, SizeIs(1));
    ASSERT_THAT(records[0].files, SizeIs(is_kept ? 1 : 0));
    if (is_kept) {
      EXPECT_EQ(records[0].files[0].source, maps.string());
      const auto copy = kept_copy(records[0], records[0].files[0].sha256);
      ASSERT_TRUE(copy.has_value());
      EXPECT_TRUE(std::filesystem::exists(*copy / "map.yaml")) << *copy;
    }
    host_->stop();
    host_.reset();
  }
}

TEST_F(IncidentRecorderTest, IsAskedForByTheService) {
  start(", after_s: 0.0");
  scans_.publish(numbered(7));
  settle();
  const auto response = ask();
  EXPECT_TRUE(response.success());
  const auto records = wait_for(1);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_THAT(response.message(), HasSubstr(records[0].folder.string()));
  EXPECT_EQ(records[0].reasons[0].kind, "asked");
  EXPECT_EQ(scans_in(records[0].folder).at("/scan"), std::vector<int>{7});
}

TEST_F(IncidentRecorderTest, ThatIsAskedForWhileOneGoesToTheDiskIsKeptAfterIt) {
  start(", after_s: 0.0, rest_s: 1000.0");
  tell("lost");
  settle();
  ASSERT_TRUE(ask().success()) << "no tick has looked after the first one yet";
  const auto records = wait_for(2);
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[0].reasons[0].kind, "lost");
  EXPECT_EQ(records[1].reasons[0].kind, "asked");
}

TEST_F(IncidentRecorderTest, WhatGoesWrongMeanwhileIsPartOfItAndNothingBeginsInItsRest) {
  start(", after_s: 1000.0, rest_s: 1000.0");
  for (const char* verdict : {"lost", "good", "lost", "good"}) tell(verdict);
  settle();
  host_->components().front()->deactivate();
  const auto records = read_records(out());
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_THAT(records[0].reasons, SizeIs(2));
  host_->components().front()->activate();
  tell("lost");
  settle();
  host_->stop();
  EXPECT_THAT(read_records(out()), SizeIs(1)) << "its rest lasts";
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
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    return !std::filesystem::exists(old.folder);
  }));
  EXPECT_THAT(wait_for(1), SizeIs(1));
}

TEST_F(IncidentRecorderTest, OnAFullDiskGoesOnAndSaysSo) {
  start(", after_s: 0.0, rest_s: 0.0");
  {
    const test::FullDisk full;
    tell("lost");
    std::vector<std::string> errors;
    EXPECT_TRUE(test::comes_true([&] {
      host_->tick();
      errors = host_->take_errors();
      return !errors.empty();
    }));
    ASSERT_FALSE(errors.empty());
    EXPECT_THAT(errors[0], HasSubstr("incidents"));
    EXPECT_THAT(errors, SizeIs(1));
    for (int i = 0; i < 50; ++i) {
      tell("lost");
      host_->tick();
    }
    EXPECT_THAT(host_->take_errors(), testing::IsEmpty()) << "told once";
  }
  tell("good");
  tell("lost");
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    const auto records = read_records(out());
    return std::any_of(records.begin(), records.end(),
                       [](const IncidentRecord& record) { return record.is_complete; });
  })) << "there is room again";
}

}  // namespace
}  // namespace strata::incident_recorder
