// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/level_changes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/pipeline/changed_room.hpp"

namespace strata::pipeline {
namespace {

const memory::TimescaleMemory& memory() {
  static const memory::TimescaleMemory room = test::changed_room();
  return room;
}

TEST(LevelChanges, CompareTheSlowestWithTheFastestLevelUnlessTold) {
  const auto map = memory().decode();
  const LevelChanges changes = level_changes(memory(), *map, {});
  EXPECT_EQ(changes.before, "long");
  EXPECT_EQ(changes.now, "short");
  ASSERT_FALSE(changes.places.empty());
  const memory::ChangedPlace& box = changes.places.front();
  EXPECT_EQ(box.kind, memory::ChangeKind::kAppeared);
  EXPECT_GT(box.min_m.x(), 1.7);
  EXPECT_LT(box.max_m.x(), 3.3);
  EXPECT_GT(box.min_m.y(), -1.3);
  EXPECT_LT(box.max_m.y(), 1.3);
  LevelChangesTask backwards;
  backwards.before = "short";
  backwards.now = "long";
  const LevelChanges reverse = level_changes(memory(), *map, backwards);
  EXPECT_EQ(reverse.places.front().kind, memory::ChangeKind::kVanished);
  backwards.now = "yearly";
  EXPECT_THROW((void)level_changes(memory(), *map, backwards), ConfigError);
}

TEST(LevelChanges, TellHowTheShortestPathDiffersBetweenLevels) {
  LevelChangesTask task;
  task.paths = {{{0.5, 0.0}, {4.3, 0.0}}, {{-0.8, 1.9}, {3.0, 2.1}}, {{0.0, 0.0}, {40.0, 0.0}}};
  const LevelChanges changes = level_changes(memory(), *memory().decode(), task);
  ASSERT_EQ(changes.paths.size(), 3U);
  const auto length_on = [&](std::size_t path, std::size_t level) {
    return length_m(*changes.paths[path][level].path);
  };
  // Straight through where the box was not yet; 1.25 m aside with it.
  ASSERT_EQ(changes.paths[0][0].level, "short");
  ASSERT_EQ(changes.paths[0][2].level, "long");
  EXPECT_NEAR(length_on(0, 2), 3.8, 0.2);
  EXPECT_GT(length_on(0, 0), 4.3);
  EXPECT_NEAR(*changes.paths[0][0].frechet_m, 1.25, 0.35);
  EXPECT_EQ(*changes.paths[0][2].frechet_m, 0.0);
  // Along the wall nothing has changed.
  EXPECT_LT(*changes.paths[1][0].frechet_m, 0.3);
  for (const LevelPath& path : changes.paths[2]) {
    EXPECT_FALSE(path.path.has_value());
    EXPECT_FALSE(path.frechet_m.has_value());
  }
  const auto json = to_json(changes, task);
  EXPECT_EQ(json["paths"][2]["levels"][0]["length_m"], nullptr);
  EXPECT_EQ(json["paths"][0]["levels"][2]["length_m"], length_on(0, 2));
  EXPECT_EQ(json["places"][0]["kind"], "appeared");
}

TEST(LevelChanges, AreDrawnAMapALevelAndAPathEach) {
  const test::TemporaryDirectory folder;
  LevelChangesTask task;
  task.paths = {{{0.5, 0.0}, {4.3, 0.0}}};
  const auto map = memory().decode();
  draw_level_changes(folder.path(), *map, level_changes(memory(), *map, task));
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    names.push_back(entry.path().filename());
    EXPECT_GT(std::filesystem::file_size(entry.path()), 500U);
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("changes.png", "level_long.png", "level_mid.png",
                                                   "level_short.png", "path_1.png"));
}

}  // namespace
}  // namespace strata::pipeline
