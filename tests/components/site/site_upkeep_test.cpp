// SPDX-License-Identifier: Apache-2.0
// What a site removes, and what it writes down.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/site/site_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using test::SiteTest;
using testing::ElementsAre;

TEST_F(SiteTest, RemovesWhatIsOldAndNothingThatIsNeeded) {
  Site site = make();
  const std::string first = activated(site, "first");
  const std::string a = activated(site, "a");
  const std::string b = activated(site, "b");
  const std::string passed_over = add(site, "c");
  const std::string d = activated(site, "d");
  const std::string approved = add(site, "e");
  site.approve(approved, test::kAda, "seen");
  const std::string fresh = add(site, "f");
  EXPECT_EQ(site.remove_rubbish({.keep_retired = 1, .dry_run = true}, test::kAda).size(), 2U);
  EXPECT_EQ(site.versions().size(), 7U);
  std::vector<std::string> gone;
  for (const auto& status : site.remove_rubbish({.keep_retired = 1}, test::kAda)) {
    gone.push_back(status.version.hash);
  }
  EXPECT_THAT(gone, ElementsAre(a, passed_over));
  EXPECT_EQ(site.versions().front().version.hash, first) << "its frame is the site's";
  EXPECT_THAT(states(site), ElementsAre("retired", "retired", "active", "approved", "candidate"));
  EXPECT_EQ(site.rollback(test::kAda).to, b);
  fs::resize_file(site.maps_of(fresh) / "strata.db", 1);
  ASSERT_EQ(site.remove_rubbish({.damaged = true}, test::kAda).size(), 1U);
  EXPECT_EQ(site.active(), b);
  EXPECT_EQ(site.find(d).state, VersionState::kRetired);
}

TEST_F(SiteTest, KeepsADiaryOfWhoDidWhat) {
  Site site = make();
  (void)activated(site, "a");
  std::vector<std::string> all;
  for (const Event& event : site.decisions().diary)
    all.push_back(event.what + " " + event.actor.by);
  EXPECT_THAT(all, ElementsAre("init ada", "add ada", "approve ada", "activate ada"));
}

}  // namespace
}  // namespace strata::site
