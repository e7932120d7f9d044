// SPDX-License-Identifier: Apache-2.0
#include "components/map_saver/map_saver.hpp"

#include <chrono>
#include <filesystem>
#include <thread>
#include <tuple>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "components/bus/service.hpp"
#include "components/convert/map_messages.hpp"
#include "components/log/map_file.hpp"
#include "components/map_saver/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::map_saver {
namespace {

/// A map with an obstacle, a free cell, something in between and the unknown, latched.
class SaveMap : public testing::Test {
 protected:
  SaveMap() {
    runtime::Registry registry;
    register_component(registry);
    host_ = test::make_host("{type: strata::MapSaver, name: map_saver, parameters: {folder: '" +
                                folder_.path().string() + "', save_map_timeout_s: 5}}",
                            registry, participant_);
    grid_.at({-3, 2}) = 1.0F;
    grid_.at({3, 5}) = 0.0F;
    grid_.at({0, 3}) = 0.5F;
    writer_.publish(convert::to_occupancy(grid_, Stamp(), "map"));
  }

  [[nodiscard]] bool save(const nav2_msgs::srv::SaveMap_Request& request) {
    const auto response = bus::call_service<bus::srv::SaveMap>(
        test::make_participant(), "/map_saver/save_map", request, std::chrono::seconds(20));
    EXPECT_TRUE(response.has_value());
    return response && response->result();
  }

  test::TemporaryDirectory folder_;
  ReflectionGrid grid_ = make_reflection_grid(0.1, CellRect{{-3, 2}, {4, 6}});
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  bus::Writer<nav_msgs::msg::OccupancyGrid> writer_{participant_, "/map_filtered",
                                                    bus::qos_profile("latched")};
  std::unique_ptr<runtime::Host> host_;
};

TEST_F(SaveMap, WritesTheMapOfAnyTopicAsMapServerReadsIt) {
  host_->activate();
  nav2_msgs::srv::SaveMap_Request request;
  request.map_topic("map_filtered");
  request.map_url("floor1");
  request.image_format("pgm");
  request.map_mode("trinary");
  request.free_thresh(0.25F);
  request.occupied_thresh(0.65F);
  ASSERT_TRUE(save(request));
  const ReflectionGrid saved = log::read_map(folder_.path() / "floor1.yaml");
  EXPECT_EQ(saved.get({-3, 2}), 1.0F);
  EXPECT_EQ(saved.get({3, 5}), 0.0F);
  EXPECT_FALSE(is_known(saved.get({0, 3})));
  EXPECT_FALSE(is_known(saved.get({1, 2})));
}

TEST_F(SaveMap, TakesTheThresholdsOfTheRequest) {
  host_->activate();
  nav2_msgs::srv::SaveMap_Request request;
  request.map_topic("/map_filtered");
  request.map_url((folder_.path() / "strict.yaml").string());
  request.free_thresh(0.1F);
  request.occupied_thresh(0.4F);
  ASSERT_TRUE(save(request));
  EXPECT_EQ(log::read_map(folder_.path() / "strict.yaml").get({0, 3}), 1.0F);
  const YAML::Node written = YAML::LoadFile((folder_.path() / "strict.yaml").string());
  EXPECT_EQ(written["free_thresh"].as<double>(), 0.1);
  EXPECT_EQ(written["occupied_thresh"].as<double>(), 0.4);
}

TEST_F(SaveMap, WritesPngAndEveryModeThatNav2Has) {
  host_->activate();
  nav2_msgs::srv::SaveMap_Request request;
  request.map_topic("map_filtered");
  for (const auto& [format, mode, image] : {std::tuple{"png", "", "trinary.png"},
                                            {"PNG", "raw", "raw.png"},
                                            {"", "raw", "raw.pgm"},
                                            {"", "scale", "scale.png"}}) {
    const std::string name = std::filesystem::path(image).stem().string();
    request.map_url(name);
    request.image_format(format);
    request.map_mode(mode);
    ASSERT_TRUE(save(request)) << image;
    const auto yaml = folder_.path() / (name + ".yaml");
    const YAML::Node written = YAML::LoadFile(yaml.string());
    EXPECT_EQ(written["image"].as<std::string>(), image);
    EXPECT_EQ(written["mode"].as<std::string>(), name);
    EXPECT_EQ(written["free_thresh"].as<double>(), 0.25) << "nav2's";
    EXPECT_EQ(written["occupied_thresh"].as<double>(), 0.65);
    const ReflectionGrid saved = log::read_map(yaml);
    EXPECT_EQ(saved.get({-3, 2}), 1.0F);
    EXPECT_EQ(saved.get({3, 5}), 0.0F);
    EXPECT_EQ(is_known(saved.get({0, 3})), name != "trinary");
    EXPECT_FALSE(is_known(saved.get({1, 2}))) << image;
  }
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(SaveMap, RefusesWhatItCannotDoAndWritesNothing) {
  nav2_msgs::srv::SaveMap_Request request;
  request.map_topic("map_filtered");
  request.map_url("refused");
  EXPECT_FALSE(save(request)) << "while inactive";
  host_->activate();
  request.image_format("jpg");
  EXPECT_FALSE(save(request)) << "as jpg";
  request.image_format("pgm");
  request.map_mode("heap");
  EXPECT_FALSE(save(request)) << "in a mode that there is not";
  request.map_mode("scale");
  EXPECT_FALSE(save(request)) << "transparent as pgm";
  request.map_mode("trinary");
  request.free_thresh(0.9F);
  EXPECT_FALSE(save(request)) << "with thresholds crossed";
  request.free_thresh(0.0F);
  request.map_url("");
  EXPECT_FALSE(save(request)) << "without a name";
  request.map_url("missing_folder/map");
  EXPECT_FALSE(save(request)) << "into a folder that is not there";
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  EXPECT_EQ(host_->take_errors().size(), 6U);
}

TEST(SaveMaps, WaitForTheNextMapWhereItsPublisherLatchesNone) {
  const test::TemporaryDirectory folder;
  runtime::Registry registry;
  register_component(registry);
  const auto host = test::make_host(
      "{type: strata::MapSaver, name: map_saver, parameters: {folder: '" + folder.path().string() +
          "', save_map_timeout_s: 20, "
          "map_subscribe_transient_local: false}}",
      registry, test::make_participant());
  host->activate();
  bus::Writer<nav_msgs::msg::OccupancyGrid> writer(test::make_participant(), "/map",
                                                   bus::qos_profile("default"));
  const std::jthread publisher([&](const std::stop_token& stop) {
    if (!writer.raw().wait_for_readers(1, std::chrono::seconds(20))) return;
    const ReflectionGrid grid = make_reflection_grid(0.1, CellRect{{0, 0}, {4, 6}});
    while (!stop.stop_requested()) {
      writer.publish(convert::to_occupancy(grid, Stamp(), "map"));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  nav2_msgs::srv::SaveMap_Request request;
  request.map_url("next");
  const auto response = bus::call_service<bus::srv::SaveMap>(
      test::make_participant(), "/map_saver/save_map", request, std::chrono::seconds(40));
  EXPECT_TRUE(response && response->result());
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "next.yaml"));
}

TEST(SaveMaps, TwoInOneProcessSaveTheMapsOfTheirOwnNamespaces) {
  const test::TemporaryDirectory folder;
  const auto participant = test::make_participant();
  runtime::Registry registry;
  register_component(registry);
  const auto entry = [&](const std::string& scope) {
    return "{type: strata::MapSaver, name: map_saver, namespace: /" + scope +
           ", parameters: {folder: '" + folder.path().string() + "'}}";
  };
  const auto host = test::make_host(entry("a") + ", " + entry("b"), registry, participant);
  host->activate();
  std::vector<std::unique_ptr<bus::Writer<nav_msgs::msg::OccupancyGrid>>> writers;
  for (const std::string scope : {"a", "b"}) {
    ReflectionGrid grid = make_reflection_grid(0.1, CellRect{{0, 0}, {4, 6}});
    grid.at({0, 0}) = scope == "a" ? 1.0F : 0.0F;
    writers.push_back(std::make_unique<bus::Writer<nav_msgs::msg::OccupancyGrid>>(
        participant, "/" + scope + "/map", bus::qos_profile("latched")));
    writers.back()->publish(convert::to_occupancy(grid, Stamp(), "map"));
  }
  for (const std::string scope : {"a", "b"}) {
    nav2_msgs::srv::SaveMap_Request request;
    request.map_url(scope);
    const auto response = bus::call_service<bus::srv::SaveMap>(test::make_participant(),
                                                               "/" + scope + "/map_saver/save_map",
                                                               request, std::chrono::seconds(20));
    ASSERT_TRUE(response && response->result()) << scope;
  }
  EXPECT_EQ(log::read_map(folder.path() / "a.yaml").get({0, 0}), 1.0F);
  EXPECT_EQ(log::read_map(folder.path() / "b.yaml").get({0, 0}), 0.0F);
}

}  // namespace
}  // namespace strata::map_saver
