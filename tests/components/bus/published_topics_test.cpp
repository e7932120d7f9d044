// SPDX-License-Identifier: Apache-2.0
/// What a participant says is published.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::bus {
namespace {

using sensor_msgs::msg::LaserScan;

TEST(PublishedTopics, AreWithTwoTypesOfTheOneThatThisParticipantCanRead) {
  // By the numbers of participants one stranger comes before ours, one behind.
  const auto before = test::make_participant();
  const auto here = test::make_participant();
  const auto behind = test::make_participant();
  std::vector<std::unique_ptr<RawWriter>> others;
  const auto publish = [&](const std::shared_ptr<Participant>& from, const std::string& topic) {
    others.push_back(
        std::make_unique<RawWriter>(from, topic, "std_msgs/msg/String", qos_profile("latched")));
  };
  for (const auto& stranger : {before, behind}) {
    publish(stranger, "/scan");
    const std::string mark = stranger == before ? "/before" : "/behind";
    publish(stranger, mark);  // once this is known, so is what came first
    ASSERT_TRUE(test::comes_true([&] { return here->published_topics().contains(mark); }));
  }
  EXPECT_EQ(here->published_topics().at("/scan").type, "std_msgs/msg/String");
  const Reader<LaserScan> reads(here, "/scan", qos_profile("sensor_data"), [](auto) {});
  EXPECT_EQ(here->published_topics().at("/scan").type, "std_msgs/msg/String")
      << "all that there is";
  EXPECT_FALSE(here->published_topics().at("/scan").is_own);
  const Writer<LaserScan> own(here, "/scan", qos_profile("default"));
  const PublishedTopic scan = here->published_topics().at("/scan");
  EXPECT_EQ(scan.type, "sensor_msgs/msg/LaserScan");
  EXPECT_FALSE(scan.transient_local) << "strangers offer that for what cannot be read";
  EXPECT_TRUE(scan.is_own);
}

}  // namespace
}  // namespace strata::bus
