// SPDX-License-Identifier: Apache-2.0
/// The sub-maps of a localizer's folder or site, for who shows what it believes of them.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/site/site.hpp"
#include "tests/components/localizer/door_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::localizer {
namespace {

namespace fs = std::filesystem;
using strata_msgs::msg::PatchMap;
using Maps = std::vector<PatchMap>;

constexpr const char* kTopic = "/localizer/patch_map";
const Cell kDoor{60, 52};
const Cell kOther{40, 60};

/// But for when it was sent.
std::vector<std::uint8_t> bytes_of(const PatchMap& message) {
  return convert::to_cdr(convert::to_message(convert::from_message(message), Stamp(), "map"));
}

class LivePatchMap : public LiveDoor {
 protected:
  [[nodiscard]] static std::vector<std::uint8_t> wanted(const std::vector<Cell>& leaves) {
    return convert::to_cdr(convert::to_message(with_doors(leaves), Stamp(), "map"));
  }

  /// Whether a topic is there, once the localizer's others are known.
  [[nodiscard]] bool is_offered() const {
    std::map<std::string, bus::PublishedTopic> topics;
    EXPECT_TRUE(test::comes_true([&] {
      topics = robot_->published_topics();
      return topics.contains("/localization_score") && topics.contains("/particle_cloud");
    }));
    return topics.contains(kTopic);
  }

  /// A folder of maps with these doors.
  [[nodiscard]] fs::path maps_with(const std::string& name, const std::vector<Cell>& leaves) const {
    const fs::path maps = folder_.path() / name;
    fs::copy(room().folder.path(), maps, fs::copy_options::recursive);
    maps::write_patch_map(maps, with_doors(leaves));
    return maps;
  }

  void start_in(const fs::path& maps, const std::string& model) {
    std::string text = parameters_of(model, false);
    const std::string before = room().folder.path().string();
    start(text.replace(text.find(before), before.size(), maps.string()));
  }
};

TEST_F(LivePatchMap, IsThatOfTheFolderForLateJoinersAndOfTheSubmapsThatStatesAreToldOf) {
  test::Collector<strata_msgs::msg::SubmapStates> states(robot_, "/submap_states", "latched");
  start_in(maps_with("maps", {kDoor, kOther}), "patch");
  (void)next_pose();
  test::Collector<PatchMap> late(robot_, kTopic, "latched");
  const Maps maps = late.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0].header().frame_id(), "map");
  EXPECT_GT(maps[0].header().stamp().sec(), 0);
  EXPECT_EQ(bytes_of(maps[0]), wanted({kDoor, kOther}));
  const auto told = states.wait_for(1);
  ASSERT_FALSE(told.empty());
  ASSERT_EQ(told.back().states().size(), maps[0].submaps().size());
  for (std::size_t s = 0; s < maps[0].submaps().size(); ++s) {
    EXPECT_EQ(told.back().states()[s].submap(), maps[0].submaps()[s].id());
    EXPECT_EQ(told.back().states()[s].probability().size(),
              maps[0].submaps()[s].configurations().size());
  }
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LivePatchMap, IsReplacedByThatOfTheVersionThatBecomesActiveAndBack) {
  host_.reset();
  const site::Actor ada{"ada", 1'000'000'000};
  site::Site site = site::Site::create(folder_.path() / "hall", "hall-3", "map", ada);
  std::vector<std::string> hashes;
  for (const Cell& leaf : {kDoor, kOther}) {
    const fs::path maps = maps_with("maps" + std::to_string(hashes.size()), {leaf});
    hashes.push_back(site.add(maps, ada, "").status.version.hash);
    site.approve(hashes.back(), ada, "");
  }
  (void)site.activate(hashes[0], ada);
  test::Collector<PatchMap> maps(robot_, kTopic, "latched");
  start_in(site.folder(), "patch");
  const auto comes = [&](std::size_t count) {
    EXPECT_TRUE(test::comes_true([&] {
      host_->tick();
      return maps.wait_for(count, std::chrono::milliseconds(20)).size() >= count;
    }));
    return bytes_of(maps.wait_for(count).back());
  };
  EXPECT_EQ(comes(1), wanted({kDoor}));
  // It drives on; the same maps are not told again.
  for (int i = 0; i < 3; ++i) (void)next_pose();
  EXPECT_EQ(maps.wait_for(0).size(), 1U);
  (void)site.activate(hashes[1], ada);
  EXPECT_EQ(comes(2), wanted({kOther}));
  test::Collector<PatchMap> late(robot_, kTopic, "latched");
  const Maps now = late.wait_for(1);
  ASSERT_EQ(now.size(), 1U);
  EXPECT_EQ(bytes_of(now[0]), wanted({kOther}));
  EXPECT_EQ(site.rollback(ada).to, hashes[0]);
  EXPECT_EQ(comes(3), wanted({kDoor}));
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LivePatchMap, IsToldOfNoModelWithoutSubmaps) {
  start_in(maps_with("maps", {kDoor}), "filtered");
  (void)next_pose();
  EXPECT_FALSE(is_offered());
}

TEST_F(LivePatchMap, IsNotToldOfMapsThatCameOverTopics) {
  bus::Writer<PatchMap> learner(robot_, "/patch_map", bus::qos_profile("latched"));
  learner.publish(convert::to_message(with_doors({kDoor}), Stamp(), "map"));
  start_in("", "patch");
  EXPECT_TRUE(test::comes_true([&] {
    if (next_scan_ < room().observations.size()) player_->publish(next_scan_++);
    return !poses_.wait_for(1, std::chrono::milliseconds(200)).empty();
  })) << "it localizes in them";
  EXPECT_FALSE(is_offered());
}

}  // namespace
}  // namespace strata::localizer
