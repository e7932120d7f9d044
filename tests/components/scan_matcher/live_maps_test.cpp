// SPDX-License-Identifier: Apache-2.0
/// What others get of the map while the robot is mapping: topics, and a folder that is whole at any
/// moment.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/patch_messages.hpp"
#include "components/log/damaged_file.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/runtime/parameters.hpp"
#include "core/base/error.hpp"
#include "tests/components/scan_matcher/mapping_robot.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::scan_matcher {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class LiveMaps : public MappingRobot {
 protected:
  [[nodiscard]] fs::path maps() const { return folder_.path() / "maps"; }
  /// more: parameters of `maps` besides its folder.
  void begin_with_folder(const std::string& more = "") {
    begin("maps: {folder: '" + maps().string() + "'" + more + "}");
  }
  std_srvs::srv::Trigger_Response save() {
    const auto response = bus::call_service<bus::srv::Trigger>(participant_, "/slam/save", {},
                                                               std::chrono::seconds(60));
    EXPECT_TRUE(response.has_value());
    return response.value_or(std_srvs::srv::Trigger_Response());
  }
  /// Drives for as long as the part of the way from a to b takes.
  std::size_t drive_part(double a, double b) {
    const auto at = [&](double part) {
      return way_.log.begin() +
             static_cast<std::ptrdiff_t>(part * static_cast<double>(way_.log.size()));
    };
    return drive({at(a), at(b)}).size();
  }
  /// The last message of a topic, for one who begins to listen now.
  template <typename T>
  std::vector<T> listen(const std::string& topic) {
    return test::Collector<T>(participant_, topic, "latched").wait_for(1);
  }

  const Drive way_;
};

std::size_t known_cells(const nav_msgs::msg::OccupancyGrid& map) {
  return static_cast<std::size_t>(std::count_if(map.data().begin(), map.data().end(),
                                                [](std::int8_t value) { return value >= 0; }));
}

TEST_F(LiveMaps, AreThereForLateListenersFromTheFirstScanAndGrow) {
  begin("maps: {publish_every_s: 0.05}");
  EXPECT_EQ(drive({way_.log.front()}).size(), 1U);
  const auto map = listen<nav_msgs::msg::OccupancyGrid>("/map");
  const auto filtered = listen<nav_msgs::msg::OccupancyGrid>("/map_filtered");
  const auto reflection = listen<strata_msgs::msg::ReflectionGrid>("/reflection_filtered");
  const auto trajectory = listen<nav_msgs::msg::Path>("/trajectory");
  ASSERT_EQ(map.size(), 1U);
  ASSERT_EQ(filtered.size(), 1U);
  ASSERT_EQ(reflection.size(), 1U);
  ASSERT_EQ(trajectory.size(), 1U);
  EXPECT_GT(known_cells(map[0]), 100U);
  EXPECT_GT(known_cells(filtered[0]), 100U);
  EXPECT_EQ(map[0].header().frame_id(), "map");
  ASSERT_EQ(trajectory[0].poses().size(), 1U);
  EXPECT_EQ(convert::from_message(trajectory[0].poses()[0].header().stamp()),
            way_.log.front().scan.stamp);

  ASSERT_GT(drive_part(0.0, 0.5), 10U);
  // What was told a moment ago is not made anew at once.
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    const auto later = listen<nav_msgs::msg::OccupancyGrid>("/map");
    const auto longer = listen<nav_msgs::msg::Path>("/trajectory");
    return !later.empty() && known_cells(later[0]) > 2 * known_cells(map[0]) && !longer.empty() &&
           longer[0].poses().size() > 5;
  }));
}

TEST_F(LiveMaps, AreSavedWhenAskedFor) {
  begin_with_folder();
  const std_srvs::srv::Trigger_Response too_early = save();
  EXPECT_FALSE(too_early.success());
  EXPECT_THAT(too_early.message(), HasSubstr("no scan"));
  EXPECT_FALSE(fs::exists(maps()));
  const std::size_t scans = drive_part(0.0, 0.3);
  const std_srvs::srv::Trigger_Response saved = save();
  EXPECT_TRUE(saved.success()) << saved.message();
  EXPECT_THAT(saved.message(), HasSubstr(maps().string()));
  EXPECT_EQ(maps::read_earlier_runs(maps()).scans.size(), scans);
  EXPECT_GT(maps::read_maps(maps()).filtered.size(), 0U);
  EXPECT_TRUE(fs::exists(maps() / "occupancy.pgm"));
  EXPECT_TRUE(fs::exists(maps() / maps::kSummaryFile));
}

TEST_F(LiveMaps, SayWhyTheyCannotBeSaved) {
  begin("maps: {folder: ''}");
  ASSERT_GT(drive_part(0.0, 0.1), 5U);
  EXPECT_THAT(save().message(), HasSubstr("maps.folder"));
  EXPECT_FALSE(save().success());
}

TEST_F(LiveMaps, AreNotToBeKeptWhereConfiguringWouldRefuseIt) {
  begin_with_folder();
  const auto set = [&](const fs::path& folder) {
    rcl_interfaces::srv::SetParameters_Request request;
    request.parameters(
        {runtime::parameter("maps.folder", runtime::parameter_value(folder.string()))});
    const auto response = bus::call_service<bus::srv::SetParameters>(
        participant_, "/slam/set_parameters", request, std::chrono::seconds(60));
    return response && response->results()[0].successful();
  };
  fs::create_directories(folder_.path() / "other");
  std::ofstream(folder_.path() / "other" / "notes.txt") << "no maps";
  EXPECT_FALSE(set(folder_.path() / "other"));
  EXPECT_FALSE(set(folder_.path() / "other" / "notes.txt" / "below"));
  EXPECT_TRUE(set(folder_.path() / "another"));
  EXPECT_FALSE(fs::exists(folder_.path() / "another"));
}

TEST_F(LiveMaps, AreSavedWhenTheProcessEnds) {
  begin_with_folder(", save_every_s: 0");
  const std::size_t scans = drive_part(0.0, 0.3);
  EXPECT_FALSE(fs::exists(maps()));
  end();
  EXPECT_EQ(maps::read_earlier_runs(maps()).scans.size(), scans);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "nothing beside them";
}

TEST_F(LiveMaps, AreWholeAtAnyMomentWhileTheyAreReplaced) {
  begin_with_folder();
  ASSERT_GT(drive_part(0.0, 0.2), 5U);
  ASSERT_TRUE(save().success());
  std::atomic<bool> ends = false;
  std::atomic<int> reads = 0;
  std::thread reader([&] {
    for (; !ends; ++reads) EXPECT_FALSE(maps::read_earlier_runs(maps()).scans.empty());
  });
  for (int i = 2; i < 6; ++i) {
    (void)drive_part(0.1 * i, 0.1 * (i + 1));
    EXPECT_TRUE(save().success());
  }
  ends = true;
  reader.join();
  EXPECT_GT(reads, 5);
}

TEST_F(LiveMaps, GoOnFromTheirFolderWhereNoStateIsLeft) {
  begin_with_folder();
  const std::size_t first = drive_part(0.0, 0.3);
  end();
  begin_with_folder();
  EXPECT_EQ(listen<nav_msgs::msg::OccupancyGrid>("/map").size(), 1U) << "before any scan";
  const std::size_t second = drive_part(0.3, 0.5);
  EXPECT_GT(second, 5U);
  end();
  const maps::EarlierRuns both = maps::read_earlier_runs(maps());
  EXPECT_EQ(both.scans.size(), first + second);
  EXPECT_EQ(both.next_run, 2);
  const Pose2 truth = between(way_.path[0], way_.path[way_.log.size() / 2 - 1]);
  const Pose2 found = between(both.scans.front().map_from_robot, both.scans.back().map_from_robot);
  EXPECT_LT(translation_distance(found, truth), 0.3);
}

TEST_F(LiveMaps, OfWhichABadDiskLeftAPartAreSetAsideAndMappingBeginsAnew) {
  const auto truncate = [](const fs::path& file) { std::ofstream(file, std::ios::trunc); };
  const auto cut = [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) / 2); };
  const std::vector<std::function<void()>> damages = {
      [&] { truncate(maps() / maps::kStoreFile); }, [&] { fs::remove(maps() / maps::kStoreFile); },
      [&] { cut(maps() / maps::kSummaryFile); }, [&] { truncate(maps() / maps::kSummaryFile); }};
  for (std::size_t i = 0; i < damages.size(); ++i) {
    SCOPED_TRACE(i);
    begin_with_folder();
    ASSERT_GT(drive_part(0.0, 0.2), 5U);
    ASSERT_TRUE(save().success());
    end();
    damages[i]();
    begin_with_folder();
    const auto errors = host_->take_errors();
    ASSERT_FALSE(errors.empty());
    EXPECT_THAT(errors[0], HasSubstr("set aside"));
    ASSERT_GT(drive_part(0.0, 0.2), 5U);
    EXPECT_TRUE(save().success());
    end();
    fs::remove_all(maps());
  }
  const auto is_aside = [](const auto& entry) { return log::is_set_aside(entry.path()); };
  EXPECT_EQ(std::count_if(fs::directory_iterator(folder_.path()), {}, is_aside), 4);
}

TEST_F(LiveMaps, OfAnotherAreLeftAlone) {
  fs::create_directories(maps());
  std::ofstream(maps() / "thesis.txt") << "years of work";
  EXPECT_THROW(begin_with_folder(), OutputError);
  EXPECT_TRUE(fs::exists(maps() / "thesis.txt"));
}

TEST_F(LiveMaps, KeepThePatchesOfTheirFolderUntilThereAreNewOnes) {
  begin_with_folder();
  ASSERT_GT(drive_part(0.0, 0.2), 5U);
  ASSERT_TRUE(save().success());
  EXPECT_FALSE(maps::read_maps(maps()).patches.has_value());
  end();
  patch::PatchMap patches;
  patches.base = maps::read_maps(maps()).filtered;
  patch::Submap door;
  door.rect = {{10, 10}, {20, 20}};
  door.contradictory = Grid<std::uint8_t>(0.05, door.rect, 1);
  for (const float value : {0.0F, 1.0F}) {
    const ReflectionGrid state(0.05, door.rect, value);
    door.configurations.push_back({Grid<CellCounts>(0.05, door.rect), state, 0.5});
  }
  patches.submaps.push_back(door);
  maps::write_patch_map(maps(), patches);
  std::ofstream(maps() / "note.txt") << "the user's";

  begin_with_folder();
  ASSERT_GT(drive_part(0.2, 0.4), 5U);
  bus::Writer<strata_msgs::msg::PatchMap> learner(participant_, "/patch_map",
                                                  bus::qos_profile("latched"));
  ASSERT_TRUE(learner.raw().wait_for_readers(1, std::chrono::seconds(20)));
  patch::PatchMap nothing;
  nothing.base = patches.base;
  learner.publish(convert::to_message(nothing, Stamp(), "map"));
  ASSERT_TRUE(save().success());
  const auto kept = maps::read_maps(maps()).patches;
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(kept->submaps.size(), 1U);
  EXPECT_EQ(fs::file_size(maps() / "note.txt"), 10U) << "what is not ours stays";
}

TEST_F(LiveMaps, AreNotPutInThePlaceOfMapsThatCameMeanwhile) {
  begin_with_folder();
  ASSERT_GT(drive_part(0.0, 0.2), 5U);
  slam::Slam slam{slam::SlamConfig{}};
  for (std::size_t i = 0; i < 50; ++i) slam.add(way_.log[i]);
  maps::write_grid_maps(maps(), slam.finish());
  maps::write_summary(maps(), "monday.clf", {});
  EXPECT_THAT(save().message(), HasSubstr("monday.clf"));
  EXPECT_EQ(maps::log_of(maps()), "monday.clf");
}

TEST_F(LiveMaps, AreNotPutInThePlaceOfAnythingElse) {
  fs::create_directory(maps());
  std::ofstream(maps() / "thesis.tex") << "years of work";
  EXPECT_THROW(begin_with_folder(), OutputError);
  EXPECT_EQ(fs::file_size(maps() / "thesis.tex"), 13U);
  fs::remove(maps() / "thesis.tex");
  // Maps that `strata learn` made: the mapper knows nothing of their log.
  slam::Slam slam{slam::SlamConfig{}};
  for (std::size_t i = 0; i < 50; ++i) slam.add(way_.log[i]);
  maps::write_grid_maps(maps(), slam.finish());
  maps::write_summary(maps(), "monday.clf", {});
  try {
    begin_with_folder();
    FAIL() << "it began";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("monday.clf"));
  }
  EXPECT_EQ(maps::read_earlier_runs(maps()).log, "monday.clf");
}

}  // namespace
}  // namespace strata::scan_matcher
