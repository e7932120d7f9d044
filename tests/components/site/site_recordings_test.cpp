// SPDX-License-Identifier: Apache-2.0
/// What a site keeps for its gate.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/site/site.hpp"
#include "core/base/error.hpp"
#include "tests/components/site/small_maps.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/watched_disk.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using testing::ElementsAre;

class SiteRecordings : public testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  /// A log of so many bytes.
  [[nodiscard]] fs::path log(const std::string& name, std::size_t bytes) const {
    std::ofstream(at(name)) << std::string(bytes, name.front());
    return at(name);
  }
  [[nodiscard]] static std::vector<std::string> names(const Site& site) {
    std::vector<std::string> all;
    for (const KeptRecording& one : site.recordings()) {
      all.push_back(one.log.filename().string());
    }
    return all;
  }
  test::TemporaryDirectory folder_;
  Site site_ = Site::create(at("hall"), "hall-3", "map", test::kAda);
};

TEST_F(SiteRecordings, AreCopiesInTheOrderOfComing) {
  EXPECT_TRUE(site_.recordings().empty());
  (void)site_.keep(log("monday.clf", 10), {}, 1000, test::kAda);
  (void)site_.keep(log("b.clf", 20), log("b.tum", 5), 1000, test::kAda);
  fs::remove(at("monday.clf"));
  const auto all = site_.recordings();
  ASSERT_THAT(names(site_), ElementsAre("monday.clf", "b.clf"));
  EXPECT_EQ(test::bytes_of(all[0].log), std::string(10, 'm'));
  EXPECT_TRUE(all[0].truth.empty());
  EXPECT_EQ(all[1].truth.filename(), "b.tum");
  EXPECT_EQ(all[1].bytes, 25U);
  EXPECT_EQ(site_.decisions().diary.back().what, "keep");
}

TEST_F(SiteRecordings, KeepTheNewestThatFit) {
  (void)site_.keep(log("a.clf", 40), {}, 100, test::kAda);
  (void)site_.keep(log("b.clf", 40), {}, 100, test::kAda);
  const auto gone = site_.keep(log("c.clf", 50), {}, 100, test::kAda);
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_EQ(gone[0].log.filename(), "a.clf");
  EXPECT_THAT(names(site_), ElementsAre("b.clf", "c.clf"));
  EXPECT_EQ(site_.keep(log("d.clf", 90), {}, 100, test::kAda).size(), 2U);
  EXPECT_THAT(names(site_), ElementsAre("d.clf"));
}

TEST_F(SiteRecordings, GoOutOfSightAtOnce) {
  (void)site_.keep(log("a.clf", 60), {}, 100, test::kAda);
  const test::WatchedDisk disk;
  Site watched(at("hall"), disk);
  (void)watched.keep(log("b.clf", 60), {}, 100, test::kAda);
  const std::vector<std::string>& steps = disk.steps();
  const auto hides =
      std::find(steps.begin(), steps.end(), "rename 000001_a.clf to .000001_a.clf.partial");
  ASSERT_NE(hides, steps.end());
  EXPECT_NE(std::find(hides, steps.end(), "remove .000001_a.clf.partial"), steps.end());
}

TEST_F(SiteRecordings, GoOnCountingBeyondSixDigits) {
  const fs::path folder = at("hall/recordings/1000000_a.clf/log");
  fs::create_directories(folder);
  std::ofstream(folder / "a.clf") << "a";
  (void)site_.keep(log("b.clf", 1), {}, 100, test::kAda);
  EXPECT_THAT(names(site_), ElementsAre("a.clf", "b.clf"));
  EXPECT_EQ(site_.recordings().back().number, 1'000'001);
}

TEST_F(SiteRecordings, RefuseWhatIsTooLargeForAllAndKeepTheOthers) {
  (void)site_.keep(log("a.clf", 40), {}, 100, test::kAda);
  EXPECT_THROW((void)site_.keep(log("b.clf", 101), {}, 100, test::kAda), InputError);
  EXPECT_THAT(names(site_), ElementsAre("a.clf"));
}

TEST_F(SiteRecordings, OfAFolderAreTheFolder) {
  fs::create_directories(at("bag"));
  std::ofstream(at("bag/metadata.yaml")) << "m";
  std::ofstream(at("bag/bag_0.db3")) << "dd";
  (void)site_.keep(at("bag/"), {}, 100, test::kAda);
  ASSERT_THAT(names(site_), ElementsAre("bag"));
  EXPECT_EQ(test::bytes_of(site_.recordings()[0].log / "bag_0.db3"), "dd");
}

TEST_F(SiteRecordings, StayAsTheyWereOnAFullDisk) {
  (void)site_.keep(log("a.clf", 10), {}, 50'000, test::kAda);
  const fs::path large = log("b.clf", 40'000);
  {
    const test::FullDisk full(20'000);
    EXPECT_THROW((void)site_.keep(large, {}, 50'000, test::kAda), OutputError);
  }
  EXPECT_THAT(names(site_), ElementsAre("a.clf"));
  EXPECT_EQ(test::bytes_of(site_.recordings()[0].log), std::string(10, 'a'));
  EXPECT_TRUE(site_.keep(large, {}, 50'000, test::kAda).empty());
}

TEST_F(SiteRecordings, DoWithoutWhatAKilledProgramLeft) {
  (void)site_.keep(log("a.clf", 10), {}, 100, test::kAda);
  const fs::path left = at("hall/recordings/.000002_b.clf.partial-999999999/log");
  fs::create_directories(left);
  std::ofstream(left / "b.clf") << "half";
  EXPECT_THAT(names(site_), ElementsAre("a.clf"));
  (void)site_.keep(log("c.clf", 10), {}, 100, test::kAda);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_THAT(names(site_), ElementsAre("a.clf", "c.clf"));
}

}  // namespace
}  // namespace strata::site
