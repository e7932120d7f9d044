// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/process_user.hpp"

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "components/bus/participant.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"

namespace strata::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t kPort = 7411;  // 1CF3

/// A machine with a process 7 of the user that runs this test.
class ProcessUser : public testing::Test {
 protected:
  ProcessUser() {
    fs::create_directories(folders_.processes / "7");
    fs::create_directories(folders_.processes / "net");
    fs::create_directories(folders_.shared_memory);
  }
  /// As proc(5) lists it: a socket of a user at a port.
  void add_socket(uid_t user, const char* port) const {
    std::ofstream(folders_.processes / "net" / "udp")
        << "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid\n"
           "  300: 00000000:"
        << port << " 00000000:0000 07 00000000:00000000 00:00000000 00000000  " << user
        << "        0 4242 2 0000000000000000 0\n";
  }
  [[nodiscard]] std::string user(std::uint16_t id) const {
    return user_of_process(id, {kPort}, folders_);
  }
  const test::TemporaryDirectory folder_;
  SystemFolders folders_{folder_.path() / "proc", folder_.path() / "shm"};
};

TEST_F(ProcessUser, IsKnownWhereThatUserAlsoListensAtAPortOfTheParticipant) {
  add_socket(getuid(), "1CF3");
  EXPECT_EQ(user(7), own_user());
  EXPECT_EQ(user(8), "") << "there is no such process";
}

TEST_F(ProcessUser, IsKnownWhereThatUserOwnsItsPortInSharedMemory) {
  std::ofstream(folders_.shared_memory / "fastrtps_port7411").close();
  EXPECT_EQ(user(7), own_user());
}

// Process 7 of a container is not our process 7.
TEST_F(ProcessUser, IsNotKnownWhereTheProcessOfThatNumberIsNotTheOneThatListens) {
  EXPECT_EQ(user(7), "") << "nobody listens here";
  add_socket(getuid() + 1, "1CF3");
  EXPECT_EQ(user(7), "") << "somebody else does";
  add_socket(getuid(), "1CF4");
  EXPECT_EQ(user(7), "") << "at another port";
}

TEST(ProcessUserOfAParticipant, IsFoundByThePortsThatItAnnounces) {
  for (const auto transport : {bus::Transport::kDefault, bus::Transport::kSharedMemory}) {
    const auto doctor = test::make_participant(transport);
    const auto other = test::make_participant(transport);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    std::vector<bus::DiscoveredParticipant> found;
    while (found.empty() && std::chrono::steady_clock::now() < deadline) {
      for (const auto& participant : doctor->view().participants) {
        if (participant.guid == other->guid()) found.push_back(participant);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].uses_shared_memory, transport == bus::Transport::kSharedMemory);
    EXPECT_EQ(user_of_process(static_cast<std::uint16_t>(getpid()), found[0].ports), own_user())
        << bus::transport_name(transport);
  }
}

}  // namespace
}  // namespace strata::doctor
