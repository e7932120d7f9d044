// SPDX-License-Identifier: Apache-2.0
#include "components/recorder/recorder.hpp"

#include <filesystem>
#include <iterator>
#include <map>
#include <utility>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "components/recorder/register.hpp"
#include "core/base/error.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::recorder {
namespace {

using Messages = std::map<std::string, std::vector<std::vector<std::uint8_t>>>;

Messages read_bag(const std::filesystem::path& folder) {
  const auto reader = log::BagReader::open(folder);
  Messages messages;
  log::BagMessage message;
  while (reader->next(message)) {
    messages[reader->topics()[message.topic].name].push_back(message.data);
  }
  EXPECT_EQ(reader->damage().count, 0U);
  return messages;
}

class RecorderStorage : public testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] std::unique_ptr<runtime::Host> make(const std::string& parameters) {
    runtime::Registry registry;
    register_component(registry);
    return test::make_host("{type: strata::Recorder, name: recorder, parameters: {out: '" +
                               bag().string() + "', storage: " + GetParam() + parameters + "}}",
                           registry, participant_);
  }
  [[nodiscard]] std::filesystem::path bag() const { return folder_.path() / "bag"; }
  [[nodiscard]] bus::Writer<sensor_msgs::msg::LaserScan> writer(const std::string& topic,
                                                                const std::string& qos) const {
    return {participant_, topic, bus::qos_profile(qos)};
  }
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();

 private:
  test::TemporaryDirectory folder_;
};

sensor_msgs::msg::LaserScan numbered(int number) {
  sensor_msgs::msg::LaserScan scan;
  scan.header().stamp().sec(number);
  scan.ranges().assign(100, static_cast<float>(number));
  return scan;
}

TEST_P(RecorderStorage, KeepsEveryMessageOfEveryTopicByteForByte) {
  auto scans = writer("/scan", "default");
  auto others = writer("/other", "sensor_data");
  const auto host = make("");
  host->activate();
  Messages sent;
  for (int i = 0; i < 200; ++i) {
    scans.publish(numbered(i));
    others.publish(numbered(1000 + i));
    sent["/scan"].push_back(convert::to_cdr(numbered(i)));
    sent["/other"].push_back(convert::to_cdr(numbered(1000 + i)));
  }
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  const Messages recorded = read_bag(bag());
  ASSERT_EQ(recorded.size(), sent.size());
  for (const auto& [topic, messages] : sent) {
    ASSERT_EQ(recorded.count(topic), 1U) << topic;
    EXPECT_EQ(recorded.at(topic).size(), messages.size()) << topic;
    EXPECT_TRUE(recorded.at(topic) == messages) << topic;
  }
}

TEST_P(RecorderStorage, GoesOnInAFolderOfItsOwnAfterARestart) {
  auto scans = writer("/scan", "default");
  const auto record = [&](int number) {
    const auto host = make(", number_if_exists: true, topics: [/scan]");
    host->activate();
    scans.publish(numbered(number));
    host->stop();
  };
  for (const int number : {1, 2, 3}) record(number);
  EXPECT_THROW((void)make(""), OutputError) << "what exists is not overwritten";
  int number = 0;
  for (const std::string suffix : {"", "_2", "_3"}) {
    EXPECT_EQ(read_bag(bag().string() + suffix),
              (Messages{{"/scan", {convert::to_cdr(numbered(++number))}}}));
  }
}

TEST_P(RecorderStorage, KeepsOnlyTheTopicsItWasAskedFor) {
  auto scans = writer("/scan", "default");
  auto others = writer("/other", "default");
  const auto host = make(", topics: [/scan, '/late:sensor_msgs/msg/LaserScan']");
  host->activate();
  auto late = writer("/late", "default");
  scans.publish(numbered(1));
  others.publish(numbered(2));
  late.publish(numbered(3));
  host->stop();
  EXPECT_EQ(read_bag(bag()), (Messages{{"/scan", {convert::to_cdr(numbered(1))}},
                                       {"/late", {convert::to_cdr(numbered(3))}}}));
}

TEST_P(RecorderStorage, KeepsTheQosThatTheWritersOffer) {
  auto scans = writer("/scan", "sensor_data");
  auto map = writer("/latched", "latched");
  const auto host = make(", topics: [/scan, /latched, '/late:sensor_msgs/msg/LaserScan']");
  host->activate();
  auto late = writer("/late", "default");
  late.publish(numbered(3));
  host->stop();
  std::map<std::string, std::pair<int, int>> offered;  // reliability, durability
  const auto reader = log::BagReader::open(bag());
  for (const log::BagTopic& topic : reader->topics()) {
    const YAML::Node qos = YAML::Load(topic.offered_qos_profiles)[0];
    offered[topic.name] = {qos["reliability"].as<int>(), qos["durability"].as<int>()};
  }
  // rosbag2's numbers: reliable 1, best effort 2; transient local 1, volatile 2.
  EXPECT_EQ(offered.at("/scan"), std::pair(2, 2));
  EXPECT_EQ(offered.at("/latched"), std::pair(1, 1));
  EXPECT_EQ(offered.at("/late"), std::pair(1, 2));
}

TEST_P(RecorderStorage, BeginsAnotherFileWhenOneIsLargeEnough) {
  auto scans = writer("/scan", "default");
  const auto host = make(", split_mb: 0.002");
  host->activate();
  for (int i = 0; i < 20; ++i) scans.publish(numbered(i));
  host->stop();
  EXPECT_GT(std::distance(std::filesystem::directory_iterator(bag()), {}), 3);
  EXPECT_EQ(read_bag(bag()).at("/scan").size(), 20U);
}

TEST_P(RecorderStorage, GoesOnInTheSameBagWhenItIsActivatedAgain) {
  auto scans = writer("/scan", "default");
  const auto host = make("");
  host->activate();
  scans.publish(numbered(1));
  host->components()[0]->deactivate();
  EXPECT_EQ(read_bag(bag()).at("/scan").size(), 1U);  // complete while it rests
  scans.publish(numbered(2));
  host->components()[0]->activate();
  auto late = writer("/late", "default");
  host->tick();                        // finds the topic
  host->components()[0]->configure();  // no transition from here; waits for the tick
  scans.publish(numbered(3));
  late.publish(numbered(4));
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()),
            (Messages{{"/scan", {convert::to_cdr(numbered(1)), convert::to_cdr(numbered(3))}},
                      {"/late", {convert::to_cdr(numbered(4))}}}));
  EXPECT_TRUE(std::filesystem::exists(bag() / "metadata.yaml"));
}

INSTANTIATE_TEST_SUITE_P(All, RecorderStorage, testing::Values("sqlite3", "mcap"));

}  // namespace
}  // namespace strata::recorder
