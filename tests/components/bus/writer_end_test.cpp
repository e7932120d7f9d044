// SPDX-License-Identifier: Apache-2.0
/// Writers that end while a reader of theirs says nothing any more.
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "components/bus/endpoint.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"

namespace strata::bus {
namespace {

using sensor_msgs::msg::LaserScan;
using std::chrono::seconds;

constexpr const char* kDomainVariable = "STRATA_TEST_DOMAIN";

[[noreturn]] void read_until_killed(int domain) {
  ParticipantOptions options;
  options.domain = domain;
  options.transport = Transport::kLoopback;
  const auto participant = std::make_shared<Participant>(options);
  const Reader<LaserScan> reader(participant, "/scan", qos_profile("lossless"), [](const auto&) {});
  while (true) pause();
}

TEST(WriterEnd, ComesAlsoWhileAReaderThatWasKilledHasNotAcknowledged) {
  // The reader is this test in a process of its own: those of one process acknowledge at once.
  if (const char* domain = std::getenv(kDomainVariable)) read_until_killed(std::stoi(domain));
  test::ChildProcess reader({"/proc/self/exe", "--gtest_filter=WriterEnd.*"},
                            {kDomainVariable + ("=" + std::to_string(test::own_domain()))});
  const auto participant = test::make_participant();
  {
    Writer<LaserScan> writer(participant, "/scan", qos_profile("lossless"));
    ASSERT_TRUE(writer.raw().wait_for_readers(1, seconds(20)));
  }
  reader.kill_hard();
  // A heartbeat comes every 20 ms: at another moment of each writer's end.
  for (int i = 0; i < 150; ++i) {
    Writer<LaserScan> writer(participant, "/scan", qos_profile("lossless"));
    if (i > 0 && writer.raw().matched() == 0) break;  // the lease of the killed one is over
    ASSERT_EQ(writer.raw().matched(), 1);
    for (int n = 0; n < 300; ++n) writer.publish(LaserScan{});
    std::this_thread::sleep_for(std::chrono::microseconds(5000 + i * 137 % 20000));
  }
}

}  // namespace
}  // namespace strata::bus
