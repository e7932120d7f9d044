// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/pages.hpp"

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tools/all_components/all_components.hpp"

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

TEST(ReferencePages, EveryKeySaysWhatItMeans) {
  for (const Page& page : make_pages()) {
    // The last column of a row is the meaning.
    EXPECT_EQ(page.text.find("|  |\n"), std::string::npos) << page.file;
  }
}

}  // namespace
}  // namespace strata::reference
