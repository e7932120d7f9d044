// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/network_findings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/names.hpp"

namespace strata::doctor {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Of a process of Fast DDS on a host.
bus::Guid guid(std::uint8_t host, std::uint8_t process, std::uint8_t entity) {
  bus::Guid result{};
  result[0] = 0x01;
  result[1] = 0x0F;
  result[2] = host;
  result[4] = process;
  result[15] = entity;
  return result;
}

constexpr std::uint8_t kHere = 1;
constexpr std::uint8_t kThere = 2;
constexpr std::uint8_t kParticipant = 0xC1;

const NameOf kNameOf = [](const bus::Guid& id) { return "process " + std::to_string(id[4]); };

bus::DiscoveredEndpoint endpoint(bus::Guid id, bool writes, bool latched = false) {
  return {id,
          writes,
          bus::wire_topic("/map"),
          bus::wire_type("nav_msgs/msg/OccupancyGrid"),
          true,
          latched,
          0.0,
          {}};
}

/// The doctor is process 9, here, as root; writer: of process 1, somewhere.
Observed heard_from(const bus::DiscoveredEndpoint& writer, const Heard& heard) {
  Observed observed;
  observed.self = guid(kHere, 9, kParticipant);
  observed.listened_s = 4.0;
  observed.view.endpoints = {writer};
  observed.heard[writer.guid] = heard;
  return observed;
}

TEST(NetworkFindings, CountMessagesThatDidNotComeFromAnotherHost) {
  const auto writer = endpoint(guid(kThere, 1, 3), true);
  const auto findings = find_losses(heard_from(writer, {15, 1000, 0.0, 101, 120, false}), kNameOf);
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].place, "/map");
  EXPECT_THAT(findings[0].what, HasSubstr("5 of 20 messages (25%) of process 1"));
  EXPECT_THAT(findings[0].advice, HasSubstr("transport: wifi"));
  EXPECT_THAT(find_losses(heard_from(writer, {20, 1000, 0.0, 101, 120, false}), kNameOf),
              IsEmpty());
}

TEST(NetworkFindings, SayNothingOfMessagesThatWereSkippedOnThisHost) {
  const auto writer = endpoint(guid(kHere, 1, 3), true);
  EXPECT_THAT(find_losses(heard_from(writer, {15, 1000, 0.0, 101, 120, false}), kNameOf),
              IsEmpty());
}

/// Nothing of a writer that has been there for so long.
Heard silence_of(double known_s) {
  Heard heard;
  heard.known_s = known_s;
  return heard;
}

TEST(NetworkFindings, NameALatchedTopicOfAnotherHostThatDoesNotArrive) {
  const auto writer = endpoint(guid(kThere, 1, 3), true, true);
  const auto findings = find_losses(heard_from(writer, silence_of(4.0)), kNameOf);
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_THAT(findings[0].what, HasSubstr("on another host"));
  EXPECT_THAT(findings[0].what, HasSubstr("nothing of it has come in 4 s"));
  EXPECT_THAT(findings[0].advice, HasSubstr("transport: wifi"));
  Heard latched = silence_of(4.0);
  latched.has_latched = true;
  EXPECT_THAT(find_losses(heard_from(writer, latched), kNameOf), IsEmpty());
}

TEST(NetworkFindings, AreAsPatientWithALatchedWriterThatCameLate) {
  const auto writer = endpoint(guid(kThere, 1, 3), true, true);
  EXPECT_THAT(find_losses(heard_from(writer, silence_of(1.5)), kNameOf), IsEmpty());
}

TEST(NetworkFindings, DoNotSayWhichHostAProcessOfAnotherVendorIsOn) {
  auto writer = endpoint(guid(kHere, 1, 3), true, true);
  writer.guid[1] = 0x10;  // Cyclone DDS
  Heard heard{15, 1000, 0.0, 101, 120, false, 4.0};
  const auto findings = find_losses(heard_from(writer, heard), kNameOf);
  ASSERT_THAT(findings, SizeIs(2));
  for (const Finding& finding : findings) {
    EXPECT_THAT(finding.what, HasSubstr("(Cyclone DDS, here or on another host"));
  }
}

// ROS 2 nodes latch what they log for ten seconds.
TEST(NetworkFindings, SayNothingOfALogInWhichNothingWasWritten) {
  auto writer = endpoint(guid(kThere, 1, 3), true, true);
  writer.wire_topic = bus::wire_topic("/rosout");
  EXPECT_THAT(find_losses(heard_from(writer, silence_of(4.0)), kNameOf), IsEmpty());
}

/// Process 1 and process 2 on the doctor's host, all with shared memory; the doctor is the first.
Observed two_processes(const std::string& first, const std::string& second) {
  Observed observed;
  observed.self = guid(kHere, 9, kParticipant);
  for (const std::uint8_t process : {1, 2, 9}) {
    observed.view.participants.push_back({guid(kHere, process, kParticipant), "/", "/", true});
  }
  observed.users = {{guid(kHere, 1, kParticipant), first},
                    {guid(kHere, 2, kParticipant), second},
                    {guid(kHere, 9, kParticipant), first}};
  return observed;
}

TEST(NetworkFindings, NameTwoUsersWhoShareMemoryThatTheyMayNotOpen) {
  const auto findings = find_users_apart(two_processes("robot", "guest"), kNameOf);
  ASSERT_THAT(findings, SizeIs(2));
  EXPECT_TRUE(findings[0].is_error);
  EXPECT_EQ(findings[0].place, "users guest and robot");
  EXPECT_THAT(findings[0].what, HasSubstr("(process 2, process 1)"));
  EXPECT_THAT(findings[0].advice, HasSubstr("without shared memory"));
  EXPECT_FALSE(findings[1].is_error);
  EXPECT_EQ(findings[1].place, "user guest");
  EXPECT_THAT(find_users_apart(two_processes("robot", "robot"), kNameOf), IsEmpty());
}

TEST(NetworkFindings, SayNothingOfUsersWhoShareNoMemoryOrAreElsewhere) {
  Observed observed = two_processes("robot", "guest");
  observed.view.participants[1].uses_shared_memory = false;
  EXPECT_THAT(find_users_apart(observed, kNameOf), IsEmpty());
  observed.view.participants[1] = {guid(kThere, 2, kParticipant), "/", "/", true};
  observed.users[guid(kThere, 2, kParticipant)] = "guest";
  EXPECT_THAT(find_users_apart(observed, kNameOf), IsEmpty());
}

TEST(NetworkFindings, SayThatTheDoctorIsDeafToAnotherUser) {
  Observed observed = two_processes("robot", "robot");
  observed.users[observed.self] = "root";
  const auto findings = find_users_apart(observed, kNameOf);
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_FALSE(findings[0].is_error);
  EXPECT_THAT(findings[0].advice, HasSubstr("run `strata doctor` as robot"));
  observed.heard[guid(kHere, 1, 3)].messages = 1;
  EXPECT_THAT(find_users_apart(observed, kNameOf), IsEmpty());
  observed.heard[guid(kHere, 1, 3)].messages = 0;
  observed.heard[guid(kHere, 1, 3)].has_latched = true;
  EXPECT_THAT(find_users_apart(observed, kNameOf), IsEmpty());
}

}  // namespace
}  // namespace strata::doctor
