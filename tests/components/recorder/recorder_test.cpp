// SPDX-License-Identifier: Apache-2.0
/// What a recorder records, and into which folders and files.
#include <filesystem>
#include <fstream>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "components/log/sqlite_handles.hpp"
#include "components/runtime/parameters.hpp"
#include "core/base/error.hpp"
#include "tests/components/recorder/recorder_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::recorder {
namespace {

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

TEST_P(RecorderStorage, RecordsTheOthersWhereATopicCannotBeRead) {
  const auto stranger = test::make_participant();
  const auto sees = [&](const std::string& topic) {
    return test::comes_true([&] { return participant_->published_topics().contains(topic); });
  };
  // This process has both with another type; one is there before the recorder, one comes later.
  const bus::Reader<sensor_msgs::msg::LaserScan> own(participant_, "/a_odd",
                                                     bus::qos_profile("default"), [](auto) {});
  const bus::Reader<sensor_msgs::msg::LaserScan> late_own(participant_, "/b_odd",
                                                          bus::qos_profile("default"), [](auto) {});
  const bus::RawWriter odd(stranger, "/a_odd", "std_msgs/msg/String", bus::qos_profile("default"));
  ASSERT_TRUE(sees("/a_odd"));
  auto scans = writer("/scan", "default");
  const auto host = make(", topics: [/a_odd, /b_odd, /scan, /z]");
  host->activate();
  const auto& recorder = dynamic_cast<const Recorder&>(*host->components().front());
  EXPECT_FALSE(recorder.is_whole());
  const bus::RawWriter late_odd(stranger, "/b_odd", "std_msgs/msg/String",
                                bus::qos_profile("default"));
  ASSERT_TRUE(sees("/b_odd"));
  auto behind = writer("/z", "default");
  host->tick();
  (void)call<bus::srv::IsPaused>("is_paused");  // after the tick
  scans.publish(numbered(1));
  behind.publish(numbered(2));
  host->stop();
  EXPECT_THAT(host->take_errors(), testing::ElementsAre(testing::HasSubstr("cannot read /a_odd"),
                                                        testing::HasSubstr("cannot read /b_odd")));
  EXPECT_EQ(read_bag(bag()), (Messages{{"/scan", {convert::to_cdr(numbered(1))}},
                                       {"/z", {convert::to_cdr(numbered(2))}}}));
  const auto reader = log::BagReader::open(bag());
  for (const log::BagTopic& topic : reader->topics()) {
    EXPECT_THAT(topic.name, testing::Not(testing::HasSubstr("odd")));
  }
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

TEST_P(RecorderStorage, KeepsATypeThatNobodyKnowsByteForByte) {
  constexpr const char* kType = "strange_msgs/msg/Thing";
  bus::RawWriter things(participant_, "/things", kType, bus::qos_profile("default"));
  const auto host = make(", topics: [/things]");
  host->activate();
  Messages sent;
  for (std::size_t size = 0; size < 40; ++size) {
    std::vector<std::uint8_t> thing = {0, 1, 0, 0};
    for (std::size_t i = 0; i < size; ++i) {
      thing.push_back(static_cast<std::uint8_t>(251 * (size + i)));
    }
    things.publish(thing);
    sent["/things"].push_back(thing);
  }
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), sent);
  const auto reader = log::BagReader::open(bag());
  ASSERT_EQ(reader->topics().size(), 1U);
  EXPECT_EQ(reader->topics()[0].type, kType);
}

TEST_P(RecorderStorage, StoresAsItWasAskedTo) {
  auto scans = writer("/scan", "default");
  const auto host = make("");
  host->activate();
  for (int i = 0; i < 100; ++i) scans.publish(numbered(i));
  host->stop();
  EXPECT_THAT(log::BagReader::open(bag())->description(),
              testing::HasSubstr(GetParam().description));
  EXPECT_EQ(read_bag(bag()).at("/scan").size(), 100U);
}

TEST_P(RecorderStorage, LeavesAnothersBagAloneWhenItIsToldToRecordThere) {
  auto scans = writer("/scan", "default");
  const auto host = make(", topics: [/scan]");
  runtime::Component& recorder = *host->components()[0];
  const auto set_out = [&](const std::filesystem::path& out) {
    rcl_interfaces::srv::SetParameters_Request request;
    request.parameters({runtime::parameter("out", runtime::parameter_value(out.string()))});
    return call<bus::srv::SetParameters>("set_parameters", request).results()[0];
  };
  const auto configure_into = [&](const std::filesystem::path& out) {
    recorder.deactivate();
    recorder.cleanup();
    const auto outcome = set_out(out);
    EXPECT_TRUE(outcome.successful()) << outcome.reason();
    recorder.configure();
    recorder.activate();
  };
  const auto anothers = bag().parent_path() / "another";
  std::filesystem::create_directories(anothers);
  std::ofstream(anothers / "bag_0.mcap") << "theirs";
  EXPECT_THAT(set_out(anothers).reason(), testing::HasSubstr("exists already"));
  EXPECT_FALSE(set_out(anothers / "bag_0.mcap" / "below").successful());
  const auto fresh = bag().parent_path() / "fresh";
  int number = 0;
  for (const auto& out : {fresh, bag(), fresh}) {
    configure_into(out);
    scans.publish(numbered(++number));
  }
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  number = 0;
  for (const std::string& folder : {fresh.string(), bag().string() + "_2", fresh.string() + "_2"}) {
    EXPECT_EQ(read_bag(folder), (Messages{{"/scan", {convert::to_cdr(numbered(++number))}}}));
  }
  EXPECT_FALSE(std::filesystem::exists(anothers.string() + "_2"));
}

/// The process works there while it lives.
class WorkingFolder {
 public:
  explicit WorkingFolder(const std::filesystem::path& folder) {
    std::filesystem::current_path(folder);
  }
  ~WorkingFolder() { std::filesystem::current_path(before_); }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

TEST_P(RecorderStorage, KnowsItsOwnBagHoweverItsFolderIsWritten) {
  auto scans = writer("/scan", "default");
  const WorkingFolder here(bag().parent_path());
  for (const auto& [out, second] :
       std::map<std::string, std::string>{{"relative", "relative_2"},
                                          {"./dotted", "dotted_2"},
                                          {"with_slash/", "with_slash_2"},
                                          {bag().string() + "//", bag().string() + "_2"}}) {
    const auto host = make_into(out, ", topics: [/scan]");
    runtime::Component& recorder = *host->components()[0];
    host->activate();
    recorder.deactivate();
    recorder.cleanup();
    EXPECT_NO_THROW(recorder.configure()) << out;
    recorder.activate();
    scans.publish(numbered(1));
    host->stop();
    EXPECT_TRUE(host->take_errors().empty()) << out;
    EXPECT_EQ(read_bag(second), (Messages{{"/scan", {convert::to_cdr(numbered(1))}}})) << out;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, RecorderStorage,
    testing::Values(Storage{"Sqlite3", "sqlite3", "SQLite schema 3"},
                    Storage{"Sqlite3SchemaFour", "sqlite3, sqlite_schema: 4", "SQLite schema 4"},
                    Storage{"Mcap", "mcap", "MCAP"},
                    Storage{"McapZstd", "mcap, compression: zstd", "MCAP, chunks packed with zstd"},
                    Storage{"McapLz4", "mcap, compression: lz4", "MCAP, chunks packed with lz4"}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::recorder
