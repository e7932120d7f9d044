// SPDX-License-Identifier: Apache-2.0
/// Our services asked by Cyclone DDS in the way of rmw_cyclonedds.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/log/bag.hpp"
#include "components/log/map_file.hpp"
#include "components/map_saver/register.hpp"
#include "components/map_server/register.hpp"
#include "components/recorder/register.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/interop/cyclone/process.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {
namespace {

/// Nothing in it is unknown, which is what map files are cut at.
ReflectionGrid full_map(int width, int height) {
  return {0.1, CellRect{{0, 0}, {width, height}}, 1.0F};
}

class CycloneServices : public testing::Test {
 protected:
  CycloneServices() {
    const auto file = folder_.path() / "room.yaml";
    log::write_map(file, full_map(5, 7));
    runtime::Registry registry;
    map_server::register_component(registry);
    map_saver::register_component(savers_);
    host_ =
        make_host("{type: strata::MapServer, name: maps, namespace: /robot1, parameters: {map: '" +
                      file.string() + "', map_frame: floor2}}",
                  registry, make_participant());
  }
  TemporaryDirectory folder_;
  runtime::Registry savers_;
  std::unique_ptr<runtime::Host> host_;
};

TEST_F(CycloneServices, LeadAComponentThroughItsLife) {
  CycloneProcess activate({"change_state", "/robot1/maps", "3"});
  EXPECT_EQ(activate.wait_for_line("success"), "success 1");
  Collector<nav_msgs::msg::OccupancyGrid> maps(make_participant(), "/robot1/map", "latched");
  EXPECT_EQ(maps.wait_for(1).size(), 1U);
}

TEST_F(CycloneServices, GiveParameters) {
  CycloneProcess get({"get_parameter", "/robot1/maps", "map_frame"});
  EXPECT_EQ(get.wait_for_line("value"), "value 4 'floor2' 0 0");
}

/// What a Cyclone process prints for one call, from `key` on.
std::string answer(const std::vector<std::string>& call, const std::string& key) {
  CycloneProcess process(call);
  return process.wait_for_line(key);
}

TEST_F(CycloneServices, TellStatesAndTransitions) {
  EXPECT_EQ(answer({"get_state", "/robot1/maps"}, "state"), "state 2 inactive");
  EXPECT_EQ(answer({"get_available_states", "/robot1/maps"}, "states"), "states 11 unconfigured");
  // Inactive: it may be cleaned up, activated or shut down.
  EXPECT_EQ(answer({"get_available_transitions", "/robot1/maps"}, "transitions"),
            "transitions 3 cleanup");
}

TEST_F(CycloneServices, ListDescribeAndSetParameters) {
  EXPECT_EQ(answer({"list_parameters", "/robot1/maps"}, "parameter map_frame"),
            "parameter map_frame");
  EXPECT_EQ(answer({"get_parameter_type", "/robot1/maps", "map_frame"}, "type"), "type 4");
  const auto saver = make_host("{type: strata::MapSaver, name: saver, namespace: /robot1}", savers_,
                               make_participant());
  EXPECT_EQ(answer({"describe_parameter", "/robot1/saver", "save_map_timeout_s"}, "descriptor"),
            "descriptor save_map_timeout_s 3 0 60");
  EXPECT_EQ(answer({"set_parameter", "/robot1/saver", "save_map_timeout_s", "7.5"}, "set"),
            "set 1 ");
  EXPECT_EQ(answer({"get_parameter", "/robot1/saver", "save_map_timeout_s"}, "value"),
            "value 3 '' 0 7.5");
  EXPECT_THAT(
      answer({"set_parameter_atomically", "/robot1/saver", "save_map_timeout_s", "61"}, "set"),
      testing::StartsWith("set 0 save_map_timeout_s"));
  EXPECT_EQ(answer({"get_parameter", "/robot1/saver", "save_map_timeout_s"}, "value"),
            "value 3 '' 0 7.5");
}

TEST_F(CycloneServices, LoadGetAndSaveMaps) {
  host_->activate();
  EXPECT_EQ(answer({"get_map", "/robot1/maps"}, "map"), "map 5 7 floor2");
  const auto larger = folder_.path() / "hall.yaml";
  log::write_map(larger, full_map(10, 3));
  EXPECT_EQ(answer({"load_map", "/robot1/maps", "file://" + larger.string()}, "loaded"),
            "loaded 0 10 3");
  EXPECT_EQ(answer({"load_map", "/robot1/maps", "file:///no/such.yaml"}, "loaded"), "loaded 1 0 0");
  const auto saver = make_host("{type: strata::MapSaver, name: saver, namespace: /robot1}", savers_,
                               make_participant());
  saver->activate();
  const auto url = folder_.path() / "saved";
  EXPECT_EQ(answer({"save_map", "/robot1/saver", "/robot1/map", url.string()}, "saved"), "saved 1");
  const auto saved = log::read_map(url.string() + ".yaml");
  EXPECT_EQ(saved.rect(), log::read_map(larger).rect());
}

TEST(CycloneClient, ThatIsThereBeforeTheServerGetsItsAnswer) {
  CycloneProcess early({"get_state", "/robot1/saver"});
  ASSERT_EQ(early.wait_for_line("made"), "made");
  runtime::Registry registry;
  map_saver::register_component(registry);
  const auto host = make_host("{type: strata::MapSaver, name: saver, namespace: /robot1}", registry,
                              make_participant());
  EXPECT_EQ(early.wait_for_line("state"), "state 2 inactive");
}

/// The first answer goes out at once and once more when the client listens for sure; a client that
/// did not listen yet gets the second only, so more than one is asked.
TEST_F(CycloneServices, AnswerANewClientAtOnce) {
  int at_once = 0;
  for (int i = 0; i < 4 && at_once == 0; ++i) {
    CycloneProcess client({"get_state_twice", "/robot1/maps"});
    ASSERT_EQ(client.wait_for_line("state"), "state 2 inactive");
    if (client.wait_for_line("again", std::chrono::seconds(5)) == "again") ++at_once;
  }
  EXPECT_GT(at_once, 0);
}

TEST(CycloneBags, ControlThePlayer) {
  const TemporaryDirectory folder;
  write_drive(folder.path() / "bag", 20);
  const auto participant = make_participant();
  Collector<sensor_msgs::msg::LaserScan> scans(participant, "/scan", "lossless");
  const auto host = play(folder.path() / "bag", ", rate: 0.001, paused: true", participant);
  host->activate();
  EXPECT_EQ(answer({"is_paused", "/player"}, "paused"), "paused 1");
  EXPECT_EQ(answer({"seek", "/player", "18"}, "success"), "success 1");
  EXPECT_EQ(answer({"seek", "/player", "180"}, "success"), "success 0");
  EXPECT_EQ(answer({"play_next", "/player"}, "success"), "success 1");
  ASSERT_EQ(scans.wait_for(1).size(), 1U);
  EXPECT_EQ(scans.wait_for(1)[0].ranges()[2], 3.0F + 17.0F);
  EXPECT_EQ(answer({"get_rate", "/player"}, "rate"), "rate 0.001");
  EXPECT_EQ(answer({"set_rate", "/player", "0"}, "success"), "success 0");
  EXPECT_EQ(answer({"set_rate", "/player", "1000000"}, "success"), "success 1");
  EXPECT_EQ(answer({"toggle_paused", "/player"}, "done"), "done");
  EXPECT_EQ(scans.wait_for(3).size(), 3U);
  EXPECT_EQ(answer({"pause", "/player"}, "done"), "done");
  EXPECT_EQ(answer({"is_paused", "/player"}, "paused"), "paused 1");
  EXPECT_EQ(answer({"resume", "/player"}, "done"), "done");
  EXPECT_EQ(answer({"is_paused", "/player"}, "paused"), "paused 0");
}

TEST(CycloneBags, ControlTheRecorder) {
  const TemporaryDirectory folder;
  const auto bag = folder.path() / "bag";
  const auto participant = make_participant();
  bus::Writer<sensor_msgs::msg::LaserScan> writer(participant, "/scan",
                                                  bus::qos_profile("default"));
  runtime::Registry registry;
  recorder::register_component(registry);
  const auto host = make_host("{type: strata::Recorder, name: recorder, parameters: {out: '" +
                                  bag.string() + "', topics: [/scan]}}",
                              registry, participant);
  host->activate();
  writer.publish({});
  EXPECT_EQ(answer({"split_bagfile", "/recorder"}, "done"), "done");
  EXPECT_EQ(answer({"pause", "/recorder"}, "done"), "done");
  EXPECT_EQ(answer({"is_paused", "/recorder"}, "paused"), "paused 1");
  writer.publish({});
  EXPECT_EQ(answer({"resume", "/recorder"}, "done"), "done");
  writer.publish({});
  host->stop();
  EXPECT_TRUE(std::filesystem::exists(bag / "bag_1.db3"));
  const auto reader = log::BagReader::open(bag);
  log::BagMessage message;
  int messages = 0;
  while (reader->next(message)) ++messages;
  EXPECT_EQ(messages, 2);
}

/// Who asks while others ask gets the own reply, whatever its way.
TEST_F(CycloneServices, AnswerBothKindsOfClientsOnOneTopic) {
  CycloneProcess cyclone({"get_parameter", "/robot1/maps", "map_frame"});
  rcl_interfaces::srv::GetParameters_Request request;
  request.names({"map_frame"});
  const auto participant = make_participant();
  for (int i = 0; i < 20; ++i) {
    const auto response = bus::call_service<bus::srv::GetParameters>(
        participant, "/robot1/maps/get_parameters", request, std::chrono::seconds(20));
    ASSERT_TRUE(response.has_value());
    ASSERT_EQ(response->values().size(), 1U);
    EXPECT_EQ(response->values()[0].string_value(), "floor2");
  }
  EXPECT_EQ(cyclone.wait_for_line("value"), "value 4 'floor2' 0 0");
}

/// Clients come and go while the service stays.
TEST_F(CycloneServices, AnswerClientsThatComeAfterOthersHaveLeft) {
  for (int i = 0; i < 8; ++i) {
    CycloneProcess get({"get_parameter", "/robot1/maps", "map_frame"});
    ASSERT_EQ(get.wait_for_line("value"), "value 4 'floor2' 0 0") << "client " << i;
  }
}

}  // namespace
}  // namespace strata::test
