// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/pages.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

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

TEST(ReferencePages, EveryKeySaysWhatItMeans) {
  for (const Page& page : make_pages()) {
    // The last column of a row is the meaning.
    EXPECT_EQ(page.text.find("|  |\n"), std::string::npos) << page.file;
  }
}

}  // namespace
}  // namespace strata::reference
