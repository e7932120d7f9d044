// SPDX-License-Identifier: Apache-2.0
/// A robot that drives while another version of its site's maps becomes active.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/site/active_maps.hpp"
#include "components/site/site.hpp"
#include "tests/components/localizer/site_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::localizer {
namespace {

using testing::HasSubstr;

TEST_F(LiveSite, GoesOnInTheVersionThatBecomesActiveAndBackWithItsPose) {
  for (int i = 0; i < 5; ++i) EXPECT_LT(error_of(next_pose()), 0.2);
  EXPECT_EQ(status("mapHash", hashes_[0]), hashes_[0]);
  EXPECT_EQ(status("mapId", "hall-3"), "hall-3");
  (void)site_->activate(hashes_[1], kAda);
  EXPECT_EQ(status("mapHash", hashes_[1]), hashes_[1]);
  EXPECT_EQ(status("mapVersion", "2"), "2");
  for (int i = 0; i < 5; ++i) EXPECT_LT(error_of(next_pose()), 0.2);
  EXPECT_EQ(site_->rollback(kAda).to, hashes_[0]);
  EXPECT_EQ(status("mapHash", hashes_[0]), hashes_[0]);
  EXPECT_EQ(status("maps taken", "3"), "3");
  for (int i = 0; i < 5; ++i) EXPECT_LT(error_of(next_pose()), 0.2);
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveSite, KeepsItsMapsWhereTheNextVersionIsDamagedAndSaysSo) {
  (void)next_pose();
  // Damaged behind the site's back: the link is set by hand.
  std::ofstream(site_->maps_of(hashes_[1]) / "summary.json", std::ios::app) << " ";
  const fs::path link = site_->folder() / "active";
  fs::remove(link);
  fs::create_directory_symlink(fs::path("versions") / hashes_[1] / "maps", link);
  std::vector<std::string> errors;
  ASSERT_TRUE(test::comes_true([&] {
    host_->tick();
    for (auto& error : host_->take_errors()) errors.push_back(error);
    return !errors.empty();
  }));
  EXPECT_THAT(errors.front(), HasSubstr("hash does not hold"));
  EXPECT_LT(error_of(next_pose()), 0.2);
  EXPECT_EQ(status("mapHash", hashes_[0]), hashes_[0]);
}

TEST_F(LiveSite, DoesNotBeginInADamagedVersion) {
  std::ofstream(site_->maps_of(hashes_[0]) / "summary.json", std::ios::app) << " ";
  try {
    start(parameters_in(site_->folder() / "active"));
    FAIL() << "it began";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("strata site rollback"));
  }
}

TEST_F(LiveLocalizer, TellsTheHashOfMapsThatAreNoSites) {
  test::Collector<diagnostic_msgs::msg::DiagnosticArray> diagnostics(robot_, "/diagnostics",
                                                                     "default");
  const std::string hash = site::identify(room().folder.path()).hash;
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    const auto all = diagnostics.wait_for(0);
    return !all.empty() && runtime::value_of(all.back().status().front(), "mapHash") == hash;
  }));
}

}  // namespace
}  // namespace strata::localizer
