// SPDX-License-Identifier: Apache-2.0
/// Decisions on a site's versions over DDS, at the localizer whose maps they are.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/bus/site_service_types.hpp"
#include "components/log/folder_lock.hpp"
#include "tests/components/localizer/site_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::localizer {
namespace {

using strata_msgs::msg::SiteVersions;
using testing::HasSubstr;

constexpr std::chrono::seconds kPatience{30};

class LiveSiteServices : public LiveSite {
 protected:
  template <typename S>
  typename bus::ServiceType<S>::Response call(
      const std::string& service, const typename bus::ServiceType<S>::Request& request) {
    const auto answer = bus::call_service<S>(robot_, "/localizer/" + service, request, kPatience);
    EXPECT_TRUE(answer.has_value()) << service;
    return answer.value_or(typename bus::ServiceType<S>::Response());
  }
  auto list() { return call<bus::srv::ListSiteVersions>("list_versions", {}); }
  auto approve(const std::string& version, bool unchecked = true, const std::string& by = "grace") {
    strata_msgs::srv::ApproveSiteVersion_Request request;
    request.version(version);
    request.by(by);
    request.unchecked(unchecked);
    return call<bus::srv::ApproveSiteVersion>("approve_version", request);
  }
  auto activate(const std::string& version) {
    strata_msgs::srv::ActivateSiteVersion_Request request;
    request.version(version);
    request.by("grace");
    return call<bus::srv::ActivateSiteVersion>("activate_version", request);
  }
  auto roll_back(const std::string& active) {
    strata_msgs::srv::RollBackSite_Request request;
    request.active(active);
    return call<bus::srv::RollBackSite>("roll_back", request);
  }
  /// A third version, which nobody has approved.
  std::string add_candidate() {
    const fs::path maps = folder_.path() / "candidate";
    fs::copy(room().folder.path(), maps, fs::copy_options::recursive);
    std::ofstream(maps / "trajectory.tum", std::ios::app) << "\n\n";
    return site_->add(maps, kAda, "tuesday").status.version.hash;
  }
  /// The next tellings of ~/site_versions until one says that of a version.
  bool is_told(const std::string& hash, const std::string& state) {
    return test::comes_true([&] {
      host_->tick();
      const auto all = told_.wait_for(0);
      if (all.empty()) return false;
      for (const auto& version : all.back().versions()) {
        if (version.hash() == hash) return version.state() == state;
      }
      return false;
    });
  }
  test::Collector<SiteVersions> told_{robot_, "/localizer/site_versions", "latched"};
};

TEST_F(LiveSiteServices, TellLaterWhatCouldNotBeRead) {
  ASSERT_TRUE(is_told(hashes_[0], "active"));
  const fs::path file = site_->folder() / site::kSiteFile;
  const std::string whole = test::bytes_of(file);
  std::ofstream(file, std::ios::trunc) << "{";
  const auto written = fs::last_write_time(file);
  const std::size_t before = told_.wait_for(0).size();
  host_->tick();
  EXPECT_FALSE(list().success()) << "behind the look at it";
  std::ofstream(file, std::ios::trunc) << whole;
  fs::last_write_time(file, written);
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    return told_.wait_for(0).size() > before;
  }));
}

TEST_F(LiveSiteServices, TellWhatThereIsWhoeverChangedIt) {
  EXPECT_TRUE(is_told(hashes_[0], "active"));
  EXPECT_TRUE(is_told(hashes_[1], "approved"));
  const std::string hash = add_candidate();
  EXPECT_TRUE(is_told(hash, "candidate"));
  (void)site_->activate(hashes_[1], kAda);
  EXPECT_TRUE(is_told(hashes_[1], "active"));
  const SiteVersions last = told_.wait_for(0).back();
  EXPECT_EQ(last.site(), "hall-3");
  EXPECT_EQ(last.header().frame_id(), "map");
  EXPECT_EQ(last.previous(), hashes_[0]);
  ASSERT_EQ(last.versions().size(), 3U);
  EXPECT_EQ(last.versions()[2].number(), 3);
  EXPECT_EQ(last.versions()[2].note(), "tuesday");
  EXPECT_EQ(last.versions()[2].made().sec(), 1);
  EXPECT_EQ(last.versions()[0].approved_by(), "ada");
  EXPECT_EQ(last.versions()[2].approved_by(), "");
  const auto listed = list();
  EXPECT_TRUE(listed.success()) << listed.message();
  EXPECT_EQ(listed.site().versions(), last.versions());
}

TEST_F(LiveSiteServices, ApproveActivateAndRollBackWhileTheRobotFollows) {
  const std::string hash = add_candidate();
  const auto approved = approve("3");
  EXPECT_TRUE(approved.success()) << approved.message();
  EXPECT_EQ(site_->find(hash).decision.approved->by, "grace over /localizer");
  EXPECT_EQ(site_->find(hash).decision.approval_note, "unchecked");
  const auto activated = activate(hash);
  EXPECT_TRUE(activated.success()) << activated.message();
  EXPECT_EQ(status("mapHash", hash), hash);
  EXPECT_LT(error_of(next_pose()), 0.2);
  const auto back = roll_back(hash);
  EXPECT_TRUE(back.success()) << back.message();
  EXPECT_EQ(status("mapHash", hashes_[0]), hashes_[0]);
  EXPECT_EQ(site_->decisions().diary.back().what, "rollback");
  EXPECT_EQ(site_->decisions().diary.back().actor.by, "somebody over /localizer");
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveSiteServices, RefuseWithTheReasonAndChangeNothing) {
  const std::string hash = add_candidate();
  EXPECT_THAT(activate(hash).message(), HasSubstr("was not approved"));
  EXPECT_THAT(approve(hash, false).message(), HasSubstr("unchecked"));
  EXPECT_THAT(approve("17").message(), HasSubstr("has no version '17'"));
  EXPECT_THAT(approve("../../etc").message(), HasSubstr("has no version"));
  EXPECT_THAT(roll_back(hashes_[1]).message(), HasSubstr("another active version"));
  EXPECT_THAT(roll_back("").message(), HasSubstr("nothing to go back to"));
  std::ofstream(site_->maps_of(hash) / "trajectory.tum", std::ios::app) << " ";
  const auto damaged = approve(hash);
  EXPECT_FALSE(damaged.success());
  EXPECT_THAT(damaged.message(), HasSubstr("trajectory.tum was changed"));
  EXPECT_EQ(site_->active(), hashes_[0]);
  EXPECT_EQ(site_->find(hash).state, site::VersionState::kCandidate);
}

TEST_F(LiveSiteServices, DoNotWaitForeverForWhoChangesTheSite) {
  const log::FolderLock held(site_->folder() / "site", [](const std::string&) { return false; });
  const auto answer = approve(hashes_[1]);
  EXPECT_FALSE(answer.success());
  EXPECT_THAT(answer.message(), HasSubstr("is changing it"));
}

TEST_F(LiveSiteServices, WriteNamesIntoTheDiaryThatItCanBeReadWith) {
  EXPECT_TRUE(approve(hashes_[1], true, "gr\xFF\nace" + std::string(500, 'e')).success());
  const std::string by = site_->find(hashes_[1]).decision.approved->by;
  EXPECT_EQ(by.find('\n'), std::string::npos);
  EXPECT_THAT(by, HasSubstr("ace"));
  EXPECT_LT(by.size(), 300U);
}

TEST_F(LiveSiteServices, GiveTheMapOfAnyVersion) {
  strata_msgs::srv::GetSiteVersionMap_Request request;
  request.version(hashes_[1]);
  const auto answer = call<bus::srv::GetSiteVersionMap>("version_map", request);
  EXPECT_TRUE(answer.success()) << answer.message();
  const auto& grid = answer.occupancy();
  EXPECT_EQ(grid.header().frame_id(), "map");
  ASSERT_EQ(grid.data().size(), std::size_t{grid.info().width()} * grid.info().height());
  EXPECT_GT(std::count(grid.data().begin(), grid.data().end(), 0), 1000);
  request.version("99");
  EXPECT_FALSE(call<bus::srv::GetSiteVersionMap>("version_map", request).success());
}

TEST_F(LiveSiteServices, TakeNoDecisionsWhereTheRobotMayNot) {
  std::string parameters = parameters_in(site_->folder());
  const std::size_t at = parameters.find("maps: ");
  ASSERT_NE(at, std::string::npos);
  start(parameters.insert(at, "site_changes: false, "));
  EXPECT_THAT(activate(hashes_[1]).message(), HasSubstr("takes no decisions"));
  EXPECT_THAT(roll_back("").message(), HasSubstr("site_changes"));
  EXPECT_THAT(approve("2").message(), HasSubstr("takes no decisions"));
  EXPECT_EQ(site_->active(), hashes_[0]);
  EXPECT_TRUE(list().success());
}

TEST_F(LiveLocalizer, OffersNoSiteWhereItsMapsAreAFolder) {
  ASSERT_GT(next_pose().header().frame_id().size(), 0U);
  const auto topics = robot_->published_topics();
  for (const auto& [topic, published] : topics) {
    EXPECT_NE(published.type, "strata_msgs/msg/SiteVersions") << topic;
  }
}

}  // namespace
}  // namespace strata::localizer
