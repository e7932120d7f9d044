// SPDX-License-Identifier: Apache-2.0
/// What a live localizer keeps of its run where its maps come over topics, belong to a site, or are
/// learned while it localizes.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/maps/node_map_message.hpp"
#include "components/site/site.hpp"
#include "tests/components/localizer/journal_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::localizer {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class JournalOfMaps : public LocalizerJournal {
 protected:
  /// In no folder.
  void begin_with_topics(const std::string& model, const std::string& more = "") {
    const std::string parameters = parameters_of(model, false);
    begin_with("{" + parameters.substr(parameters.find("model:")), more);
  }
  /// A bag's messages keep for the replay what was published, in any order.
  template <typename Message>
  void publish(bus::Writer<Message>& writer, const std::string& topic, const Message& message) {
    kept_.push_back({topic, bus::MessageType<Message>::name, convert::to_cdr(message)});
    writer.publish(message);
  }
  void drive_on(Poses& poses, std::size_t scans) {
    const Poses more = drive(scans);
    poses.insert(poses.end(), more.begin(), more.end());
  }
  JournalReplay with_messages(std::size_t scans) {
    JournalReplay journal = this->journal(scans);
    give_messages(journal);
    return journal;
  }
  void give_messages(JournalReplay& journal) const {
    for (const Kept& kept : kept_) {
      const auto found = map_message(kept.topic, kept.type, kept.cdr);
      ASSERT_TRUE(found);
      journal.add(*found, kept.cdr);
    }
  }
  /// Without the points and scans before the last but so many restore points.
  JournalReplay late_journal(std::size_t points, std::size_t scans) {
    JournalReplay journal;
    const auto all = points_->wait_for(1);
    EXPECT_GT(all.size(), points);
    const std::size_t first = all.size() - std::min(points, all.size());
    for (std::size_t n = first; n < all.size(); ++n) journal.add(restore_point(all[n]));
    for (const LabeledScan& scan : scans_->wait_for(scans)) journal.add(scan);
    return journal;
  }

  struct Kept {
    std::string topic;
    std::string type;
    std::vector<std::uint8_t> cdr;
  };
  std::vector<Kept> kept_;
  maps::Maps maps_ = maps::read_maps(room().folder.path());
  bus::Writer<nav_msgs::msg::OccupancyGrid> occupancy_{robot_, "/map", bus::qos_profile("latched")};
  bus::Writer<strata_msgs::msg::ReflectionGrid> filtered_{robot_, "/reflection_filtered",
                                                          bus::qos_profile("latched")};
  bus::Writer<strata_msgs::msg::PatchMap> patches_{robot_, "/patch_map",
                                                   bus::qos_profile("latched")};
  bus::Writer<strata_msgs::msg::NodeMap> nodes_{robot_, "/node_map", bus::qos_profile("latched")};
};

TEST_F(JournalOfMaps, ThatComeAgainOverTopicsGivesTheSamePoses) {
  begin_with_topics("patch");
  const auto send = [&](int version) {
    // What was seen least goes, and the base fades a little.
    patch::PatchMap map = *maps_.patches;
    for (int n = 0; n < version && !map.submaps.empty(); ++n) map.submaps.pop_back();
    for (float& value : map.base.values()) value *= 1.0F - 0.01F * static_cast<float>(version);
    publish(filtered_, "/reflection_filtered", convert::to_message(maps_.filtered));
    publish(patches_, "/patch_map", convert::to_message(map, Stamp(), "map"));
  };
  send(0);
  Poses poses = drive(8);
  for (int version : {1, 1, 2}) {  // once more the same
    send(version);
    drive_on(poses, 8);
  }
  JournalReplay journal = with_messages(poses.size());
  const JournalReplay::Outcome outcome = run(journal);
  EXPECT_TRUE(outcome.is_same());
  EXPECT_EQ(outcome.replayed, outcome.scans);
  EXPECT_GE(outcome.restored, 3U) << "the start, and with each map that is another";
  EXPECT_EQ(outcome.without_maps, 0U);
  EXPECT_EQ(replayed_, poses);
  EXPECT_THAT(host_->take_errors(), IsEmpty());
}

TEST_F(JournalOfMaps, ThatSomebodyElsePublishesGivesTheSamePoses) {
  begin_with_topics("occupancy");
  nav_msgs::msg::OccupancyGrid map = convert::to_occupancy(maps_.occupancy, Stamp(), "map");
  publish(occupancy_, "/map", map);
  Poses poses = drive(8);
  for (std::size_t n = 0; n < map.data().size(); n += 7) map.data()[n] = -1;
  publish(occupancy_, "/map", map);
  drive_on(poses, 8);
  JournalReplay journal = with_messages(poses.size());
  EXPECT_TRUE(run(journal).is_same());
  EXPECT_EQ(replayed_, poses);
}

TEST_F(JournalOfMaps, OfANodeMapGivesTheSamePoses) {
  begin_with_topics("timescale");
  publish(filtered_, "/reflection_filtered", convert::to_message(maps_.filtered));
  memory::TimescaleMemory memory = *maps_.timescale;
  std::shared_ptr<const memory::NodeMap> map = memory.decode();
  publish(nodes_, "/node_map", maps::to_message(memory, *map, Stamp(), "map"));
  Poses poses = drive(6);
  for (int n = 0; n < 3; ++n) {
    // The memory goes on learning elsewhere.
    for (std::size_t scan = 0; scan < room().observations.size(); ++scan) {
      const Observation& seen = room().observations[scan];
      PosedScan posed{10 + n, seen.scan, room().truth[scan], {}};
      (void)memory.observe(posed);
    }
    map = memory.decode({}, map.get());
    publish(nodes_, "/node_map", maps::to_message(memory, *map, Stamp(), "map"));
    drive_on(poses, 6);
  }
  JournalReplay journal = with_messages(poses.size());
  const JournalReplay::Outcome outcome = run(journal);
  EXPECT_TRUE(outcome.is_same());
  EXPECT_GE(outcome.restored, 3U);
  EXPECT_EQ(outcome.replayed, outcome.scans);
  EXPECT_EQ(replayed_, poses);
}

TEST_F(JournalOfMaps, LeavesOutWhatIsInMapsWhoseMessagesWereNotKept) {
  begin_with_topics("filtered");
  publish(filtered_, "/reflection_filtered", convert::to_message(maps_.filtered));
  (void)drive(8);
  kept_.clear();
  ReflectionGrid other = maps_.filtered;
  for (float& value : other.values()) value *= 0.9F;
  publish(filtered_, "/reflection_filtered", convert::to_message(other));
  (void)drive(8);
  JournalReplay lost = journal(16);
  EXPECT_THAT([&] { (void)run(lost); },
              testing::ThrowsMessage<InputError>(HasSubstr("came over topics")));
  give_messages(lost);  // those of the second map
  const JournalReplay::Outcome outcome = run(lost);
  EXPECT_TRUE(outcome.is_same());
  EXPECT_GE(outcome.without_maps, 1U);
  EXPECT_LT(outcome.replayed, outcome.scans);
}

TEST_F(JournalOfMaps, OfAFolderInWhosePlaceATopicStepsGivesTheSamePoses) {
  begin("patch", ", map_topics: {follow: true}");
  Poses poses = drive(8);
  patch::PatchMap map = *maps_.patches;
  map.submaps.clear();
  publish(patches_, "/patch_map", convert::to_message(map, Stamp(), "map"));
  drive_on(poses, 8);
  JournalReplay journal = with_messages(poses.size());
  const JournalReplay::Outcome outcome = run(journal);
  EXPECT_TRUE(outcome.is_same());
  EXPECT_EQ(outcome.restored, 2U);
  EXPECT_EQ(replayed_, poses);
}

TEST_F(JournalOfMaps, ThatAreLearnedMeanwhileGivesTheSamePosesFromAnyRestorePoint) {
  for (const std::string model : {"timescale", "timescale_short", "timescale_frozen"}) {
    SCOPED_TRACE(model);
    next_scan_ = 0;
    begin(model);
    const Poses poses = drive(30);
    const JournalReplay::Outcome whole = run(journal(poses.size()));
    EXPECT_TRUE(whole.is_same());
    EXPECT_EQ(whole.replayed, poses.size());
    EXPECT_EQ(whole.restored, 1U);
    EXPECT_GT(whole.compared, 2U);
    EXPECT_EQ(replayed_, poses);
    for (const int threads : {1, 8}) {
      const JournalReplay::Outcome late = run(late_journal(2, poses.size()), threads);
      EXPECT_TRUE(late.is_same());
      EXPECT_EQ(late.restored, 1U);
      EXPECT_EQ(late.compared, 1U);
      EXPECT_LT(late.replayed, poses.size());
      EXPECT_EQ(replayed_,
                Poses(poses.end() - static_cast<std::ptrdiff_t>(late.replayed), poses.end()));
    }
  }
}

TEST_F(JournalOfMaps, WhoseModelLearnedTooMuchHasNoRestorePointAndSaysSo) {
  test::Collector<diagnostic_msgs::msg::DiagnosticArray> told(robot_, "/diagnostics", "default");
  begin("timescale", ", restore_point_mb: 0.0");
  (void)drive(5);
  std::string said;
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    const auto all = told.wait_for(0);
    for (const auto& one : all.empty() ? std::vector<diagnostic_msgs::msg::DiagnosticStatus>()
                                       : all.back().status()) {
      said = runtime::value_of(one, "incidents");
    }
    return !said.empty();
  }));
  EXPECT_THAT(said, HasSubstr("restore_point_mb"));
  EXPECT_THAT(points_->wait_for(0), IsEmpty());
}

TEST_F(JournalOfMaps, OfASiteNamesTheVersionsFolder) {
  const test::TemporaryDirectory folder;
  const site::Actor ada{"ada", 1'000'000'000};
  site::Site hall = site::Site::create(folder.path() / "hall", "hall-3", "map", ada);
  const std::string hash = hall.add(room().folder.path(), ada, "").status.version.hash;
  hall.approve(hash, ada, "");
  (void)hall.activate(hash, ada);
  std::string parameters = parameters_of("filtered", false);
  const std::string before = room().folder.path().string();
  begin_with(parameters.replace(parameters.find(before), before.size(), hall.folder().string()));
  const Poses poses = drive(8);
  const RestorePoint point = restore_point(points_->wait_for(1).front());
  EXPECT_EQ(std::filesystem::path(point.maps), std::filesystem::canonical(hall.maps_of(hash)));
  EXPECT_EQ(point.maps_sha256, hash);
  EXPECT_TRUE(run(journal(poses.size())).is_same());
}

}  // namespace
}  // namespace strata::localizer
