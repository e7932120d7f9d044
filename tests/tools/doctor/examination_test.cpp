// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/examination.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/bus/endpoint.hpp"
#include "tests/components/bus/domain.hpp"
#include "tools/doctor/listen.hpp"

namespace strata::doctor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

bus::Guid guid(std::uint8_t participant, std::uint8_t entity) {
  bus::Guid result{};
  result[0] = 0x01;
  result[1] = 0x0F;
  result[11] = participant;
  result[15] = entity;
  return result;
}

bus::DiscoveredEndpoint endpoint(bus::Guid id, bool writes, bool reliable, bool latched,
                                 const std::string& topic = "/scan",
                                 const std::string& type = "sensor_msgs/msg/LaserScan") {
  return {id, writes, bus::wire_topic(topic), bus::wire_type(type), reliable, latched, 0.0, {}};
}

/// A driver (participant 1) and a localizer (participant 2), seen from participant 9.
Observed pair(const bus::DiscoveredEndpoint& writer, const bus::DiscoveredEndpoint& reader) {
  Observed observed;
  observed.self = guid(9, 0xC1);
  observed.listened_s = 2.0;
  for (const std::uint8_t id : {1, 2, 9}) {
    observed.view.participants.push_back({guid(id, 0xC1), "/", "/"});
  }
  observed.view.endpoints = {writer, reader};
  observed.nodes[guid(1, 0xC1)] = {{"/", "driver", {}, {guid(1, 3)}}};
  observed.nodes[guid(2, 0xC1)] = {{"/robot1", "localizer", {guid(2, 4)}, {}}};
  return observed;
}

TEST(Doctor, FindsNothingWhereEverythingFits) {
  Observed observed =
      pair(endpoint(guid(1, 3), true, true, true), endpoint(guid(2, 4), false, false, false));
  observed.heard[guid(1, 3)] = {20, 2000, 0.001};
  const Report report = examine(observed);
  EXPECT_THAT(report.findings, IsEmpty());
  EXPECT_THAT(report.participants, SizeIs(2));
  EXPECT_EQ(report.participants[0].vendor, "Fast DDS");
  EXPECT_THAT(report.participants[1].nodes, ElementsAre("/robot1/localizer"));
  ASSERT_THAT(report.topics, SizeIs(1));
  EXPECT_EQ(report.topics[0].name, "/scan");
  EXPECT_THAT(report.topics[0].writers, ElementsAre("/driver"));
  EXPECT_THAT(report.topics[0].readers, ElementsAre("/robot1/localizer"));
  EXPECT_DOUBLE_EQ(report.topics[0].rate_hz, 10.0);
  EXPECT_DOUBLE_EQ(report.topics[0].bytes_per_s, 1000.0);
  EXPECT_THAT(to_text(report), HasSubstr("no problem found"));
}

TEST(Doctor, NamesBothNodesOfAReaderThatWantsMoreThanIsOffered) {
  const Report report = examine(
      pair(endpoint(guid(1, 3), true, false, false), endpoint(guid(2, 4), false, true, true)));
  ASSERT_THAT(report.findings, SizeIs(1));
  const Finding& finding = report.findings[0];
  EXPECT_TRUE(finding.is_error);
  EXPECT_EQ(finding.place, "/scan");
  EXPECT_THAT(finding.what, HasSubstr("/driver publishes, /robot1/localizer gets nothing"));
  EXPECT_THAT(finding.advice, HasSubstr("best effort"));
  EXPECT_THAT(finding.advice, HasSubstr("transient local"));
}

TEST(Doctor, FindsTwoTypesOnOneTopic) {
  const Report report =
      examine(pair(endpoint(guid(1, 3), true, true, false),
                   endpoint(guid(2, 4), false, true, false, "/scan", "nav_msgs/msg/Odometry")));
  ASSERT_THAT(report.findings, SizeIs(1));
  EXPECT_THAT(report.findings[0].what, HasSubstr("another type"));
}

TEST(Doctor, FindsTwoVersionsOfATypeWhereBothSidesTellTheirs) {
  auto writer = endpoint(guid(1, 3), true, true, false);
  auto reader = endpoint(guid(2, 4), false, true, false);
  writer.type_hash = "RIHS01_aa";
  EXPECT_THAT(examine(pair(writer, reader)).findings, IsEmpty());
  reader.type_hash = "RIHS01_bb";
  const Report report = examine(pair(writer, reader));
  ASSERT_THAT(report.findings, SizeIs(1));
  EXPECT_FALSE(report.findings[0].is_error);
  EXPECT_THAT(report.findings[0].what, HasSubstr("RIHS01_bb"));
}

TEST(Doctor, FindsADeadlineThatNobodyKeeps) {
  auto reader = endpoint(guid(2, 4), false, true, false);
  reader.deadline_s = 0.5;
  EXPECT_THAT(examine(pair(endpoint(guid(1, 3), true, true, false), reader)).findings, SizeIs(1));
}

TEST(Doctor, TellsWhichWayAClockIsWrong) {
  Observed observed =
      pair(endpoint(guid(1, 3), true, true, false), endpoint(guid(2, 4), false, true, false));
  observed.heard[guid(1, 3)] = {5, 100, -2.5};
  EXPECT_THAT(examine(observed).findings.at(0).what, HasSubstr("ahead of ours by 2.500 s"));
  observed.heard[guid(1, 3)] = {5, 100, 3.0};
  EXPECT_THAT(examine(observed).findings.at(0).what, HasSubstr("behind ours"));
  observed.heard[guid(1, 3)] = {5, 100, 0.05};
  EXPECT_THAT(examine(observed).findings, IsEmpty());
}

TEST(Doctor, NotesATopicThatIsReadOnlyAndNodesOfOneName) {
  Observed observed =
      pair(endpoint(guid(2, 5), false, true, false), endpoint(guid(2, 4), false, true, false));
  observed.nodes[guid(1, 0xC1)] = observed.nodes[guid(2, 0xC1)];
  const Report report = examine(observed);
  ASSERT_THAT(report.findings, SizeIs(2));
  EXPECT_FALSE(report.findings[0].is_error);
  EXPECT_THAT(to_text(report), HasSubstr("published by nobody"));
  EXPECT_THAT(to_text(report), HasSubstr("two nodes have this name"));
}

/// What is told of a topic that the localizer reads and nobody publishes.
std::vector<Finding> unpublished(const std::string& topic, const std::string& type) {
  Observed observed = pair(endpoint(guid(2, 4), false, true, false, topic, type),
                           endpoint(guid(2, 4), false, true, false, topic, type));
  return examine(observed).findings;
}

TEST(Doctor, LeavesOutWhatNobodyNeedsToPublish) {
  EXPECT_THAT(unpublished("/robot1/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped"),
              IsEmpty());
  EXPECT_THAT(unpublished("/parameter_events", "rcl_interfaces/msg/ParameterEvent"), IsEmpty());
  EXPECT_THAT(unpublished("/tf_static", "tf2_msgs/msg/TFMessage"), SizeIs(1));
  EXPECT_THAT(unpublished("/odom", "nav_msgs/msg/Odometry"), SizeIs(1));
}

TEST(Doctor, TakesOdometryFromATopicOrFromTransforms) {
  const auto odom = endpoint(guid(2, 4), false, true, false, "/odom", "nav_msgs/msg/Odometry");
  const auto tf = endpoint(guid(2, 6), false, true, false, "/tf", "tf2_msgs/msg/TFMessage");
  auto driver = odom;
  driver.guid = guid(1, 3);
  driver.writes = true;
  Observed observed = pair(odom, driver);
  observed.nodes[guid(2, 0xC1)] = {{"/robot1", "localizer", {guid(2, 4), guid(2, 6)}, {}}};
  observed.view.endpoints.push_back(tf);
  EXPECT_THAT(examine(observed).findings, IsEmpty());
  observed.view.endpoints = {odom, tf};
  EXPECT_THAT(examine(observed).findings, SizeIs(2));
  observed.view.endpoints.push_back(
      endpoint(guid(1, 3), true, true, false, "/tf", "tf2_msgs/msg/TFMessage"));
  EXPECT_THAT(examine(observed).findings, IsEmpty());
}

TEST(Doctor, TellsFindingsFirstAndServicesOnlyWhenAsked) {
  Observed observed =
      pair(endpoint(guid(1, 3), true, false, false), endpoint(guid(2, 4), false, true, true));
  auto request = observed.view.endpoints[1];
  request.guid = guid(2, 7);
  request.wire_topic = "rq/robot1/localizer/get_stateRequest";
  observed.view.endpoints.push_back(request);
  const Report report = examine(observed);
  EXPECT_EQ(report.errors(), 1U);
  const std::string text = to_text(report);
  EXPECT_LT(text.find("findings\n  error: /scan"), text.find("2 participants"));
  EXPECT_LT(text.find("2 participants"), text.find("1 topic, and 1 of services and the like"));
  EXPECT_THAT(text, testing::Not(HasSubstr("get_state")));
  EXPECT_THAT(to_text(report, true), HasSubstr("get_stateRequest"));
}

TEST(Doctor, SaysWhatToLookAtWhenNobodyIsThere) {
  Observed alone;
  alone.self = guid(9, 0xC1);
  alone.view.participants = {{alone.self, "/", "/"}};
  const Report report = examine(alone);
  ASSERT_THAT(report.findings, SizeIs(1));
  EXPECT_THAT(report.findings[0].advice, HasSubstr("ROS_DOMAIN_ID"));
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json["findings"][0]["level"], "error");
  EXPECT_TRUE(json["participants"].empty());
}

TEST(Doctor, SeesALiveMismatchAndHearsARate) {
  const auto robot = test::make_participant();
  const bus::Node driver(robot, "/", "driver");
  bus::RawWriter careless(robot, "/scan", "sensor_msgs/msg/LaserScan",
                          bus::qos_profile("sensor_data"));
  const bus::RawReader demanding(robot, "/scan", "sensor_msgs/msg/LaserScan",
                                 bus::qos_profile("default"), [](const bus::RawMessage&) {});
  sensor_msgs::msg::LaserScan scan;
  scan.ranges().resize(100);
  const std::vector<std::uint8_t> bytes = convert::to_cdr(scan);
  const auto doctor = test::make_participant();
  std::unique_ptr<bus::GraphReader> witness;  // comes after the doctor's own, so knows no more
  const auto is_all_seen = [&] {
    const bus::DomainView view = doctor->view();
    return std::count_if(view.endpoints.begin(), view.endpoints.end(), [](const auto& endpoint) {
             return endpoint.wire_topic == "rt/scan";
           }) >= 3;
  };
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  int sent = 0;
  const Observed observed = listen(doctor, [&](double) {
    if (!witness) witness = std::make_unique<bus::GraphReader>(doctor);
    const bool is_ready = witness->wait_for_node("/driver", std::chrono::milliseconds(20)) &&
                          careless.wait_for_readers(1, std::chrono::milliseconds(20)) &&
                          is_all_seen();
    if (is_ready) {
      careless.publish(bytes);
      ++sent;
    }
    return sent < 50 && std::chrono::steady_clock::now() < deadline;
  });
  const Report report = examine(observed);
  ASSERT_THAT(report.findings, SizeIs(1)) << to_text(report);
  EXPECT_THAT(report.findings[0].what, HasSubstr("gets nothing"));
  ASSERT_EQ(report.participants.size(), 1U);
  EXPECT_THAT(report.participants[0].nodes, ElementsAre("/driver"));
  const auto heard = observed.heard.find(careless.guid());
  ASSERT_NE(heard, observed.heard.end());
  EXPECT_GT(heard->second.messages, 0U);
  EXPECT_EQ(heard->second.bytes, heard->second.messages * bytes.size());
}

}  // namespace
}  // namespace strata::doctor
