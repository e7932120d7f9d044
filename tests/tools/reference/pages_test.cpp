// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/pages.hpp"

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/components/maps/toy_model.hpp"
#include "tests/support/test_data.hpp"
#include "tools/all_components/all_components.hpp"
#include "tools/reference/map_models_page.hpp"

namespace strata::reference {
namespace {

TEST(ReferencePages, InTheRepositoryAreThoseOfTheCode) {
  EXPECT_THAT(outdated_pages(STRATA_REFERENCE_DIR), testing::IsEmpty())
      << "run build/release/bin/strata-reference docs/reference and commit";
}

TEST(ReferencePages, NoticeAPageThatDriftedOrIsMissing) {
  const test::TemporaryDirectory folder;
  EXPECT_EQ(outdated_pages(folder.path()).size(), make_pages().size());
  write_pages(folder.path());
  EXPECT_THAT(outdated_pages(folder.path()), testing::IsEmpty());
  std::ofstream(folder.path() / "scenario.md", std::ios::app) << "edited by hand\n";
  EXPECT_THAT(outdated_pages(folder.path()), testing::ElementsAre("scenario.md"));
}

// What strata_component() and register.hpp make known, and the folders that have one.
TEST(ReferencePages, EveryComponentIsKnownAndHasOne) {
  std::set<std::string> pages;
  std::set<std::string> titles;
  for (const Page& page : make_pages()) {
    if (page.file.starts_with("component_")) pages.insert(page.file);
    titles.insert(page.text.substr(0, page.text.find('\n')));
  }
  const runtime::Registry registry = tools::all_components();
  for (const auto& [type, factory] : registry.factories()) {
    EXPECT_THAT(titles, testing::Contains("# Parameters of " + type));
  }
  std::set<std::string> folders;
  for (const auto& entry : std::filesystem::directory_iterator(STRATA_COMPONENTS_DIR)) {
    if (!std::filesystem::exists(entry.path() / "register.hpp")) continue;
    folders.insert("component_" + entry.path().filename().string() + ".md");
  }
  EXPECT_EQ(pages, folders);
  EXPECT_EQ(registry.factories().size(), folders.size());
}

TEST(ReferencePages, OfMapModelsHaveARowForWhatIsRegistered) {
  const std::string row =
      "| `toy` | grid | the occupancy grid | yes | nav_msgs/OccupancyGrid | nothing | yes |  | a "
      "grid that only tests know |\n";
  EXPECT_THAT(map_models_page(maps::test_room::with_toy()), testing::HasSubstr(row));
  EXPECT_THAT(map_models_page(maps::map_models()), testing::Not(testing::HasSubstr("toy")));
}

TEST(ReferencePages, HaveAtMostSixtySettingsOfUsersEachWithWhenToTouchIt) {
  // One that several pages show counts once: the same key with the same text.
  std::set<std::string> settings;
  for (const Page& page : make_pages()) {
    for (const settings::ReferenceRow& row : page.rows) {
      if (row.when.empty()) continue;
      EXPECT_FALSE(settings::is_of_list(row)) << page.file << " " << row.key;
      settings.insert(row.key.substr(row.key.rfind('.') + 1) + ": " + row.doc + "; " + row.when);
      EXPECT_THAT(page.text, testing::HasSubstr(" | " + row.when + " |\n")) << row.key;
    }
  }
  EXPECT_LE(settings.size(), 60U);
  EXPECT_GE(settings.size(), 40U);
}

TEST(ReferencePages, ShowWhatUsersSetFirstAndTheRestApart) {
  for (const Page& page : make_pages()) {
    // Models and metrics, not settings.
    if (page.file == "map_models.md" || page.file == "metrics.md") continue;
    const std::size_t users = page.text.find("## Settings");
    const std::size_t experts = std::min(page.text.find("## Expert settings"), page.text.size());
    ASSERT_LT(users, experts) << page.file;
    for (const settings::ReferenceRow& row : page.rows) {
      const std::size_t at = page.text.find("| `" + row.key + "` |");
      if (row.type == "group") continue;
      ASSERT_NE(at, std::string::npos) << page.file << " " << row.key;
      EXPECT_EQ(at < experts, !row.when.empty()) << page.file << " " << row.key;
    }
  }
}

TEST(ReferencePages, ListWhatEachPresetSets) {
  std::set<std::string> presets;
  for (const Page& page : make_pages()) {
    for (const settings::PresetLine& line : page.presets) {
      presets.insert(line.preset);
      EXPECT_THAT(page.text, testing::HasSubstr("`" + line.key + ": " + line.value + "`"));
    }
  }
  EXPECT_THAT(presets,
              testing::ElementsAre("paper-em", "paper-patch", "paper-timescale", "paper-topology"));
}

TEST(ReferencePages, EveryKeySaysWhatItMeans) {
  for (const Page& page : make_pages()) {
    // The last column of a row is the meaning.
    EXPECT_EQ(page.text.find("|  |\n"), std::string::npos) << page.file;
  }
}

}  // namespace
}  // namespace strata::reference
