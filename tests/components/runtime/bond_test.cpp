// SPDX-License-Identifier: Apache-2.0
/// The heartbeat that nav2's lifecycle manager wants of a node.
#include "components/runtime/bond.hpp"

#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "components/log/map_file.hpp"
#include "components/map_server/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::runtime {
namespace {

using bond::msg::Status;

/// The manager's side of the bond "maps".
class BondOf : public testing::Test {
 protected:
  void say(bool active, const std::string& id = "maps", float timeout_s = 4.0F) {
    Status status;
    status.id(id);
    status.instance_id("manager");
    status.active(active);
    status.heartbeat_timeout(timeout_s);
    status.heartbeat_period(0.1F);
    writer_.publish(status);
  }
  /// What came from others than the manager, once there is something after `tick`s.
  template <typename Tick>
  [[nodiscard]] std::vector<Status> answers(std::size_t count, Tick tick, bool say_active) {
    std::vector<Status> others;
    for (int i = 0; i < 200 && others.size() < count; ++i) {
      if (say_active) say(true);
      tick();
      others.clear();
      const std::size_t all = seen_.wait_for(0).size();
      for (const Status& status : seen_.wait_for(all + 1, std::chrono::milliseconds(100))) {
        if (status.instance_id() != "manager") others.push_back(status);
      }
    }
    return others;
  }

  std::shared_ptr<bus::Participant> manager_ = test::make_participant();
  bus::Writer<Status> writer_{manager_, "/robot1/bond", bus::qos_profile("default")};
  test::Collector<Status> seen_{manager_, "/robot1/bond", "default"};
};

TEST_F(BondOf, AnActiveComponentAnswersItsManagerUntilItIsDeactivated) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "room.yaml";
  log::write_map(file, make_reflection_grid(0.1, CellRect{{0, 0}, {4, 6}}));
  Registry registry;
  map_server::register_component(registry);
  const auto host = test::make_host(
      "{type: strata::MapServer, name: maps, namespace: /robot1, parameters: {map: '" +
          file.string() + "'}}",
      registry, test::make_participant());
  host->activate();
  const auto beats = answers(
      3, [&] { host->tick(); }, true);
  ASSERT_GE(beats.size(), 3U);
  for (const Status& beat : beats) {
    EXPECT_EQ(beat.id(), "maps");
    EXPECT_TRUE(beat.active());
    EXPECT_EQ(beat.instance_id(), beats[0].instance_id());
    EXPECT_GT(beat.heartbeat_timeout(), beat.heartbeat_period());
  }
  const std::size_t before = beats.size();
  host->components()[0]->deactivate();
  const auto after = answers(
      before + 1, [&] { host->tick(); }, false);
  ASSERT_GT(after.size(), before);
  EXPECT_FALSE(after.back().active());
}

TEST_F(BondOf, NothingIsSentToWhoDoesNotAsk) {
  const auto participant = test::make_participant();
  Bond bond(participant, "/robot1/bond", "maps");
  Bond beside(participant, "/robot1/bond", "beside");
  // Bonds of other nodes, and the own one at its end; what the one beside has heard, ours has too.
  for (int i = 0; i < 200 && !beside.is_formed(); ++i) {
    for (int k = 0; k < 3; ++k) {
      say(true, "others");
      say(false);
      say(true, "beside");
    }
    bond.tick();
    (void)seen_.wait_for(10000, std::chrono::milliseconds(20));
  }
  ASSERT_TRUE(beside.is_formed());
  EXPECT_FALSE(bond.is_formed());
  // What is sent now is the first: ours answers who asks.
  const auto beats = answers(
      1, [&] { bond.tick(); }, true);
  ASSERT_EQ(beats.size(), 1U);
  EXPECT_TRUE(beats[0].active());
  EXPECT_TRUE(bond.is_formed());
}

TEST_F(BondOf, AManagerThatEndsItIsAnsweredOnceAndThenNoMore) {
  Bond bond(test::make_participant(), "/robot1/bond", "maps");
  const auto beats = answers(
      1, [&] { bond.tick(); }, true);
  ASSERT_FALSE(beats.empty());
  say(false);
  const auto after = answers(
      beats.size() + 1,
      [&] {
        if (!bond.is_formed()) bond.tick();
      },
      false);
  ASSERT_GT(after.size(), beats.size());
  EXPECT_FALSE(after.back().active());
  EXPECT_FALSE(bond.is_formed());
}

TEST_F(BondOf, AManagerThatFallsSilentIsForgotten) {
  Bond bond(test::make_participant(), "/robot1/bond", "maps");
  for (int i = 0; i < 200 && !bond.is_formed(); ++i) {
    say(true, "maps", 0.3F);
    (void)seen_.wait_for(1000, std::chrono::milliseconds(20));
  }
  ASSERT_TRUE(bond.is_formed());
  for (int i = 0; i < 200 && bond.is_formed(); ++i) {
    bond.tick();
    (void)seen_.wait_for(1000, std::chrono::milliseconds(20));
  }
  EXPECT_FALSE(bond.is_formed());
}

}  // namespace
}  // namespace strata::runtime
