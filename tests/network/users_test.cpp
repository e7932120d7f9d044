// SPDX-License-Identifier: Apache-2.0
/// Two users of one host; with Fast DDS they may not open each other's shared memory.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/network/network_fixture.hpp"

namespace strata::test {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kRobot = "61001";
constexpr const char* kOperator = "61002";
constexpr const char* kSharing =
    "FASTRTPS_DEFAULT_PROFILES_FILE=" STRATA_SOURCE_DIR "/tests/network/ros2_fastdds.xml";

class Users : public Network {
 protected:
  /// Runs on the only host as that user.
  [[nodiscard]] std::unique_ptr<ChildProcess> run_as(
      const std::string& user, const std::vector<std::string>& command) const {
    std::vector<std::string> words = {"setpriv", "--reuid=" + user, "--regid=" + user,
                                      "--clear-groups"};
    words.insert(words.end(), command.begin(), command.end());
    return network_->run(0, words);
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> person(const std::string& user,
                                                     const std::string& transport,
                                                     const std::string& number,
                                                     const std::string& variable = "NONE=") const {
    auto process = run_as(user, {"env", variable, STRATA_NETWORK_PEER, transport, "meet", number});
    EXPECT_EQ(process->wait_for_line("ready"), "ready");
    return process;
  }
  [[nodiscard]] std::string doctor_of(const std::string& user, const std::string& transport,
                                      const std::string& variable = "NONE=") const {
    return run_as(user, {"env", variable, STRATA_PROGRAM, "doctor", "--seconds", "4", "--transport",
                         transport})
        ->rest();
  }
};

TEST_F(Users, HearEachOther) {
  STRATA_MAKE_HOSTS(1);
  for (const char* transport : {"default", "localhost", "wifi", "loopback"}) {
    const auto first = person(kRobot, transport, "1");
    const auto second = person(kOperator, transport, "2");
    EXPECT_EQ(first->wait_for_line("met", kPatience), "met 2") << transport;
    EXPECT_EQ(second->wait_for_line("met", kPatience), "met 1") << transport;
  }
}

// ROS 2's Fast DDS processes share memory; ours does not, so it hears those of every user.
TEST_F(Users, HearAnothersProcessThatSharesMemory) {
  STRATA_MAKE_HOSTS(1);
  const auto first = person(kRobot, "default", "1", kSharing);
  const auto second = person(kOperator, "default", "2");
  EXPECT_EQ(first->wait_for_line("met", kPatience), "met 2");
  EXPECT_EQ(second->wait_for_line("met", kPatience), "met 1");
}

TEST_F(Users, WhoBothShareMemoryDoNotHearEachOtherAndAreNamedByTheDoctor) {
  STRATA_MAKE_HOSTS(1);
  const auto first = person(kRobot, "default", "1", kSharing);
  const auto second = person(kOperator, "default", "2", kSharing);
  const std::string report = doctor_of(kRobot, "default", kSharing);
  EXPECT_THAT(report, HasSubstr("error: users 61001 and 61002: run processes here"));
  EXPECT_THAT(report, HasSubstr("without shared memory"));
  EXPECT_THAT(report, HasSubstr("note: user 61002: runs"));
  EXPECT_EQ(first->wait_for_line("met", seconds(1)), "");
  EXPECT_EQ(second->wait_for_line("met", seconds(1)), "");
}

TEST_F(Users, WithoutSharedMemoryAreNothingToTheDoctor) {
  STRATA_MAKE_HOSTS(1);
  const auto first = person(kRobot, "default", "1");
  const auto second = person(kOperator, "default", "2");
  EXPECT_EQ(first->wait_for_line("met", kPatience), "met 2");
  EXPECT_THAT(doctor_of(kRobot, "default"), Not(HasSubstr("user")));
}

}  // namespace
}  // namespace strata::test
