// SPDX-License-Identifier: Apache-2.0
#include "components/recorder/recorder.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <thread>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "components/bus/bag_service_types.hpp"
#include "components/bus/service.hpp"
#include "components/log/sqlite_handles.hpp"
#include "components/recorder/register.hpp"
#include "components/runtime/parameters.hpp"
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

struct Storage {
  const char* name;
  const char* parameters;
  const char* description;  ///< what the reader tells of the bag
};

class RecorderStorage : public testing::TestWithParam<Storage> {
 protected:
  [[nodiscard]] std::unique_ptr<runtime::Host> make(const std::string& parameters) {
    return make_into(bag().string(), parameters);
  }
  [[nodiscard]] std::unique_ptr<runtime::Host> make_into(const std::string& out,
                                                         const std::string& parameters) {
    runtime::Registry registry;
    register_component(registry);
    return test::make_host("{type: strata::Recorder, name: recorder, parameters: {out: '" + out +
                               "', storage: " + GetParam().parameters + parameters + "}}",
                           registry, participant_);
  }
  [[nodiscard]] std::filesystem::path bag() const { return folder_.path() / "bag"; }
  [[nodiscard]] bus::Writer<sensor_msgs::msg::LaserScan> writer(const std::string& topic,
                                                                const std::string& qos) const {
    return {participant_, topic, bus::qos_profile(qos)};
  }
  template <typename S>
  typename bus::ServiceType<S>::Response call(
      const std::string& name, const typename bus::ServiceType<S>::Request& request = {}) {
    const auto response =
        bus::call_service<S>(participant_, "/recorder/" + name, request, std::chrono::seconds(20));
    EXPECT_TRUE(response.has_value()) << name;
    return response.value_or(typename bus::ServiceType<S>::Response());
  }
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();

 private:
  test::TemporaryDirectory folder_;
};

/// As messages are stamped.
std::int64_t now_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

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

TEST_P(RecorderStorage, BeginsAnotherFileWhenOneSpansTheTime) {
  auto scans = writer("/scan", "default");
  const auto host = make(", split_s: 1e-9");  // less than any two messages are apart
  host->activate();
  for (int i = 0; i < 10; ++i) scans.publish(numbered(i));
  host->stop();
  const YAML::Node files =
      YAML::LoadFile((bag() / "metadata.yaml").string())["rosbag2_bagfile_information"]["files"];
  ASSERT_EQ(files.size(), 10U);
  for (const YAML::Node& file : files) EXPECT_EQ(file["message_count"].as<int>(), 1);
  EXPECT_EQ(read_bag(bag()).at("/scan").size(), 10U);
}

TEST_P(RecorderStorage, LeavesOutWhatComesWhileItIsPaused) {
  auto scans = writer("/scan", "default");
  const auto host = make("");
  host->activate();
  EXPECT_FALSE(call<bus::srv::IsPaused>("is_paused").paused());
  scans.publish(numbered(1));
  call<bus::srv::Pause>("pause");
  EXPECT_TRUE(call<bus::srv::IsPaused>("is_paused").paused());
  scans.publish(numbered(2));
  call<bus::srv::Resume>("resume");
  scans.publish(numbered(3));
  rcl_interfaces::srv::SetParameters_Request pause;
  pause.parameters({runtime::parameter("paused", runtime::parameter_value(true))});
  EXPECT_TRUE(call<bus::srv::SetParameters>("set_parameters", pause).results().at(0).successful());
  EXPECT_TRUE(call<bus::srv::IsPaused>("is_paused").paused());
  scans.publish(numbered(4));
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()).at("/scan"),
            (std::vector{convert::to_cdr(numbered(1)), convert::to_cdr(numbered(3))}));
}

TEST_P(RecorderStorage, RecordsWhatWasLatchedWhileItWasPausedOnceItGoesOn) {
  auto map = writer("/map", "latched");
  auto other_map = writer("/map", "latched");
  auto scans = writer("/scan", "default");
  const auto host = make(", paused: true, topics: [/map, /scan]");
  host->activate();
  map.publish(numbered(1));
  call<bus::srv::Resume>("resume");
  scans.publish(numbered(2));
  call<bus::srv::Pause>("pause");
  scans.publish(numbered(3));
  const std::int64_t before_ns = now_ns();
  map.publish(numbered(4));
  other_map.publish(numbered(5));
  map.publish(numbered(6));
  const std::int64_t after_ns = now_ns();
  EXPECT_TRUE(call<bus::srv::IsPaused>("is_paused").paused());
  const std::int64_t kept_ns = now_ns();
  while (now_ns() - kept_ns <= after_ns - before_ns) std::this_thread::yield();
  for (const int again : {0, 1}) {  // nothing is left that would be recorded twice
    call<bus::srv::Resume>("resume");
    if (again == 0) call<bus::srv::Pause>("pause");
  }
  scans.publish(numbered(7));
  call<bus::srv::Pause>("pause");
  map.publish(numbered(8));
  host->stop();  // still paused
  EXPECT_TRUE(host->take_errors().empty());
  const auto reader = log::BagReader::open(bag());
  std::vector<std::vector<std::uint8_t>> recorded;
  std::vector<std::int64_t> stamps;
  for (log::BagMessage message; reader->next(message);) {
    recorded.push_back(message.data);
    stamps.push_back(message.stamp.ns);
  }
  std::vector<std::vector<std::uint8_t>> expected;
  for (const int number : {1, 2, 5, 6, 7}) expected.push_back(convert::to_cdr(numbered(number)));
  ASSERT_TRUE(recorded == expected);
  EXPECT_LT(stamps[1], before_ns);
  EXPECT_GT(stamps[2], after_ns) << "where the recording goes on, not where it was published";
}

TEST_P(RecorderStorage, KeepsAsManyLatchedMessagesOfAWriterAsItIsToldTo) {
  bus::QosProfile qos = bus::qos_profile("latched");
  qos.depth = 5;
  bus::Writer<sensor_msgs::msg::LaserScan> things(participant_, "/things", qos);
  for (const int depth : {0, 1, 3}) {
    const auto host = make(
        ", number_if_exists: true, paused: true, topics: [/things], "
        "latched_depth: " +
        std::to_string(depth));
    host->activate();
    for (int i = 0; i < 6; ++i) things.publish(numbered(i));
    call<bus::srv::Resume>("resume");
    host->stop();
    const auto folder = depth == 0 ? bag().string() : bag().string() + (depth == 1 ? "_2" : "_3");
    std::vector<std::vector<std::uint8_t>> last;
    for (int i = 6 - depth; i < 6; ++i) last.push_back(convert::to_cdr(numbered(i)));
    EXPECT_EQ(read_bag(folder)["/things"], last) << depth;
  }
}

TEST_P(RecorderStorage, LeavesAnothersBagAloneWhenItIsToldToRecordThere) {
  auto scans = writer("/scan", "default");
  const auto host = make(", topics: [/scan]");
  runtime::Component& recorder = *host->components()[0];
  const auto configure_into = [&](const std::filesystem::path& out) {
    recorder.deactivate();
    recorder.cleanup();
    rcl_interfaces::srv::SetParameters_Request request;
    request.parameters({runtime::parameter("out", runtime::parameter_value(out.string()))});
    EXPECT_TRUE(call<bus::srv::SetParameters>("set_parameters", request).results()[0].successful());
    recorder.configure();
    recorder.activate();
  };
  const auto anothers = bag().parent_path() / "another";
  std::filesystem::create_directories(anothers);
  std::ofstream(anothers / "bag_0.mcap") << "theirs";
  EXPECT_THROW(configure_into(anothers), OutputError) << "it has never recorded there";
  EXPECT_EQ(recorder.state(), runtime::LifecycleState::kUnconfigured);
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

TEST_P(RecorderStorage, BeginsAnotherFileWhenItIsAskedTo) {
  auto scans = writer("/scan", "default");
  const auto host = make(", topics: [/scan]");
  host->activate();
  for (const int number : {1, 2, 3}) {
    scans.publish(numbered(number));
    call<bus::srv::SplitBagfile>("split_bagfile");
    call<bus::srv::SplitBagfile>("split_bagfile");  // nothing has come that would need a file
  }
  scans.publish(numbered(4));
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  const YAML::Node info =
      YAML::LoadFile((bag() / "metadata.yaml").string())["rosbag2_bagfile_information"];
  ASSERT_EQ(info["files"].size(), 4U);
  for (const YAML::Node& file : info["files"]) EXPECT_EQ(file["message_count"].as<int>(), 1);
  EXPECT_EQ(read_bag(bag()).at("/scan").size(), 4U);
}

/// Where one message can be refused and the next one not.
class RecorderIntoSqlite : public RecorderStorage {
 protected:
  /// The bag takes nothing of that topic any more.
  void refuse(const std::string& topic) {
    sqlite3* opened = nullptr;
    ASSERT_EQ(sqlite3_open((bag() / "bag_0.db3").c_str(), &opened), SQLITE_OK);
    const log::Database database(opened);
    const std::string sql =
        "CREATE TRIGGER refuse BEFORE INSERT ON messages WHEN NEW.topic_id = "
        "(SELECT id FROM topics WHERE name = '" +
        topic + "') BEGIN SELECT RAISE(ABORT, 'not that one'); END";
    ASSERT_EQ(sqlite3_exec(opened, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(opened);
  }
};

TEST_P(RecorderIntoSqlite, TellsWhatItCannotRecordWhenItGoesOnAndRecordsTheRest) {
  auto bad = writer("/bad", "latched");
  auto good = writer("/good", "latched");
  const auto host = make(", paused: true, topics: [/bad, /good]");
  host->activate();
  host->tick();                                 // the topics are in the file
  (void)call<bus::srv::IsPaused>("is_paused");  // after the tick
  refuse("/bad");
  bad.publish(numbered(1));
  good.publish(numbered(2));
  rcl_interfaces::srv::SetParameters_Request resume;
  resume.parameters({runtime::parameter("paused", runtime::parameter_value(false))});
  EXPECT_TRUE(call<bus::srv::SetParameters>("set_parameters", resume).results().at(0).successful());
  EXPECT_FALSE(call<bus::srv::IsPaused>("is_paused").paused());
  EXPECT_THAT(host->take_errors(), testing::ElementsAre(testing::HasSubstr("bag_0.db3")));
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), (Messages{{"/good", {convert::to_cdr(numbered(2))}}}));
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

TEST_P(RecorderStorage, LeavesItsBagCompleteWhenItIsResumedWhileItRests) {
  auto map = writer("/map", "latched");
  const auto host = make(", paused: true, topics: [/map]");
  runtime::Component& recorder = *host->components()[0];
  host->activate();
  map.publish(numbered(1));
  (void)call<bus::srv::IsPaused>("is_paused");  // after the message
  for (const bool goes_on : {false, true}) {
    recorder.deactivate();
    call<bus::srv::Resume>("resume");
    EXPECT_TRUE(std::filesystem::exists(bag() / "metadata.yaml"));
    EXPECT_TRUE(read_bag(bag()).empty());
    if (!goes_on) call<bus::srv::Pause>("pause");
    recorder.activate();
  }
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), (Messages{{"/map", {convert::to_cdr(numbered(1))}}}));
}

TEST_P(RecorderStorage, KeepsWhatIsLatchedOnATopicThatNobodyPublishedYet) {
  const auto host = make(", paused: true, topics: ['/map:sensor_msgs/msg/LaserScan']");
  host->activate();
  auto map = writer("/map", "latched");
  map.publish(numbered(1));
  call<bus::srv::Resume>("resume");
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), (Messages{{"/map", {convert::to_cdr(numbered(1))}}}));
}

TEST_P(RecorderStorage, KeepsWhatIsLatchedOnceNobodyPublishesTheTopicOtherwise) {
  auto volatile_map = std::make_unique<bus::Writer<sensor_msgs::msg::LaserScan>>(
      participant_, "/map", bus::qos_profile("default"));
  const auto host = make(", paused: true, topics: [/map]");
  host->activate();
  auto map = writer("/map", "latched");
  map.publish(numbered(1));
  (void)call<bus::srv::IsPaused>("is_paused");  // after the message
  volatile_map.reset();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!participant_->published_topics()["/map"].transient_local) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  host->tick();  // finds it
  (void)call<bus::srv::IsPaused>("is_paused");
  map.publish(numbered(2));
  call<bus::srv::Resume>("resume");
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), (Messages{{"/map", {convert::to_cdr(numbered(2))}}}));
}

INSTANTIATE_TEST_SUITE_P(
    All, RecorderStorage,
    testing::Values(Storage{"Sqlite3", "sqlite3", "SQLite schema 3"},
                    Storage{"Sqlite3SchemaFour", "sqlite3, sqlite_schema: 4", "SQLite schema 4"},
                    Storage{"Mcap", "mcap", "MCAP"},
                    Storage{"McapZstd", "mcap, compression: zstd", "MCAP, chunks packed with zstd"},
                    Storage{"McapLz4", "mcap, compression: lz4", "MCAP, chunks packed with lz4"}),
    [](const auto& each) { return std::string(each.param.name); });
INSTANTIATE_TEST_SUITE_P(All, RecorderIntoSqlite,
                         testing::Values(Storage{"Sqlite3", "sqlite3", "SQLite schema 3"}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::recorder
