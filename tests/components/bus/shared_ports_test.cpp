// SPDX-License-Identifier: Apache-2.0
/// Which files at the ports of shared memory are trusted.
#include "components/bus/shared_ports.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "components/bus/endpoint.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"

namespace strata::bus {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kDomain = 7;

class SharedPorts : public testing::Test {
 protected:
  const test::TemporaryDirectory folder_;

  fs::path make(const std::string& name) const {
    const fs::path file = folder_.path() / name;
    std::ofstream(file) << "what another release left";
    return file;
  }
  /// Of the first participant's discovery.
  [[nodiscard]] static std::string port_name(int domain) {
    return "fastrtps_port" +
           std::to_string(kSharedPorts.base + 250 * domain + kSharedPorts.discovery);
  }
};

TEST_F(SharedPorts, AreClearedOfWhatIsLeftWhereNobodyUsesThem) {
  const fs::path port = make(port_name(kDomain));
  const fs::path lock = make(port_name(kDomain) + "_el");
  const fs::path mutex = make("sem." + port_name(kDomain) + "_mutex");
  const SharedPortClaim claim(kDomain, folder_.path());
  for (const fs::path& file : {port, lock, mutex}) EXPECT_FALSE(fs::exists(file)) << file;
}

TEST_F(SharedPorts, AreLeftAloneWhileAnotherUsesThem) {
  auto first = std::make_unique<SharedPortClaim>(kDomain, folder_.path());
  const fs::path port = make(port_name(kDomain));
  auto second = std::make_unique<SharedPortClaim>(kDomain, folder_.path());
  EXPECT_TRUE(fs::exists(port));
  first.reset();
  const SharedPortClaim third(kDomain, folder_.path());
  EXPECT_TRUE(fs::exists(port));
  second.reset();
}

TEST_F(SharedPorts, OfOtherDomainsAndNamesAreLeftAlone) {
  const fs::path before = make(port_name(kDomain - 1));
  const fs::path after = make(port_name(kDomain + 1));
  const fs::path usual = make("fastrtps_port" + std::to_string(7400 + 250 * kDomain + 10));
  const fs::path segment = make("fastrtps_974d27f10541dd8f");
  const fs::path longer = make(port_name(kDomain) + "x");
  const SharedPortClaim claim(kDomain, folder_.path());
  for (const fs::path& file : {before, after, usual, segment, longer}) {
    EXPECT_TRUE(fs::exists(file)) << file;
  }
}

TEST_F(SharedPorts, OfAnotherUserAreRefusedAndKept) {
  const fs::path port = make(port_name(kDomain));
  if (::chown(port.c_str(), 61001, 61001) != 0) GTEST_SKIP() << "needs root";
  try {
    const SharedPortClaim claim(kDomain, folder_.path());
    FAIL() << "trusted another user's file";
  } catch (const OutputError& error) {
    EXPECT_EQ(error.place(), port.string());
    EXPECT_THAT(error.problem(), HasSubstr("belongs to another user"));
    EXPECT_THAT(error.remedy(), HasSubstr("transport: default"));
  }
  EXPECT_TRUE(fs::exists(port));
}

TEST_F(SharedPorts, ThatAnotherUserClaimedAreRefused) {
  const fs::path claimed = make("strata_shared_ports_" + std::to_string(kDomain));
  if (::chown(claimed.c_str(), 61001, 61001) != 0) GTEST_SKIP() << "needs root";
  EXPECT_THROW(SharedPortClaim(kDomain, folder_.path()), OutputError);
}

TEST_F(SharedPorts, OfADomainLieBetweenTheUsualOnesOfItAndTheOneBefore) {
  constexpr int kUsualBase = 7400;
  constexpr int kUsualLast = 10 + 1 + 2 * 100;  // the ports of the hundredth participant
  for (const int domain : {0, 1, 100, 232}) {
    const int first = kSharedPorts.base + 250 * domain + kSharedPorts.discovery;
    const int last = kSharedPorts.base + 250 * domain + kSharedPorts.all_user;
    EXPECT_GT(first, kUsualBase + 250 * (domain - 1) + kUsualLast);
    EXPECT_LT(last, kUsualBase + 250 * domain);
    EXPECT_LE(last, 65535);
  }
  EXPECT_LT(kSharedPorts.user + kSharedMemoryParticipants, kSharedPorts.all_discovery + 1);
}

TEST_F(SharedPorts, LetAllParticipantsOfAHostMeet) {
  std::vector<std::shared_ptr<Participant>> participants;
  for (int i = 0; i < kSharedMemoryParticipants; ++i) {
    participants.push_back(test::make_participant(Transport::kSharedMemory));
  }
  const RawWriter writer(participants.front(), "/scan", "sensor_msgs/msg/LaserScan",
                         qos_profile("default"));
  std::vector<std::unique_ptr<RawReader>> readers;
  for (const auto& participant : participants) {
    readers.push_back(std::make_unique<RawReader>(participant, "/scan", "sensor_msgs/msg/LaserScan",
                                                  qos_profile("default"),
                                                  [](const RawMessage&) {}));
  }
  EXPECT_TRUE(writer.wait_for_readers(kSharedMemoryParticipants, std::chrono::seconds(60)));
}

}  // namespace
}  // namespace strata::bus
