// SPDX-License-Identifier: Apache-2.0
#include "components/site/site.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/components/site/site_fixture.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using test::SiteTest;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(SiteTest, NamesVersionsByTheirContentAndKeepsWhatTheyAreMadeOf) {
  Site site = make();
  const std::string hash = add(site, "a");
  EXPECT_EQ(hash, log::hash_content(at("maps-a")).hash);
  EXPECT_EQ(log::hash_content(site.maps_of(hash)).hash, hash);
  ASSERT_EQ(site.versions().size(), 1U);
  const MapVersion version = site.versions()[0].version;
  EXPECT_EQ(version.number, 1);
  EXPECT_EQ(version.site, "hall-3");
  EXPECT_EQ(version.frame, "map");
  EXPECT_EQ(version.made.by, "ada");
  EXPECT_EQ(version.parent, "");
  EXPECT_EQ(version.facts.at("log"), "monday.clf");
  EXPECT_EQ(version.files.size(), 3U);
}

TEST_F(SiteTest, TakesTheSameMapsOnce) {
  Site site = make();
  const std::string hash = add(site, "a");
  fs::copy(at("maps-a"), at("copy"), fs::copy_options::recursive);
  const Site::Added again = site.add(at("copy"), test::kAda, "once more");
  EXPECT_FALSE(again.is_new);
  EXPECT_EQ(again.status.version.hash, hash);
  EXPECT_EQ(site.versions().size(), 1U);
}

TEST_F(SiteTest, LeadsAVersionFromCandidateToRetired) {
  Site site = make();
  const std::string a = add(site, "a");
  EXPECT_THAT(states(site), ElementsAre("candidate"));
  site.approve(a, test::kAda, "seen");
  EXPECT_THAT(states(site), ElementsAre("approved"));
  EXPECT_EQ(site.activate(a, test::kAda).from, "");
  EXPECT_THAT(states(site), ElementsAre("active"));
  const std::string b = activated(site, "b");
  EXPECT_THAT(states(site), ElementsAre("retired", "active"));
  EXPECT_EQ(site.find("2").version.parent, a);
  EXPECT_EQ(fs::canonical(at("hall") / "active"), fs::canonical(site.maps_of(b)));
  EXPECT_EQ(Site(at("hall")).active(), b);
}

TEST_F(SiteTest, ActivatesOnlyWhatWasApproved) {
  Site site = make();
  const std::string a = activated(site, "a");
  const std::string b = add(site, "b");
  EXPECT_THAT(error_of([&] { (void)site.activate(b, test::kAda); }), HasSubstr("was not approved"));
  EXPECT_EQ(site.active(), a);
}

TEST_F(SiteTest, GoesBackStepByStepAndForthAgain) {
  Site site = make();
  const std::string a = activated(site, "a");
  const std::string b = activated(site, "b");
  const std::string c = activated(site, "c");
  EXPECT_EQ(site.find("previous").version.hash, b);
  EXPECT_EQ(site.rollback(test::kAda).to, b);
  EXPECT_EQ(site.rollback(test::kAda).to, a);
  EXPECT_THAT(error_of([&] { (void)site.rollback(test::kAda); }),
              HasSubstr("nothing to go back to"));
  EXPECT_EQ(site.active(), a);
  EXPECT_EQ(site.activate(c, test::kAda).from, a);
  EXPECT_EQ(site.rollback(test::kAda).to, a);
}

TEST_F(SiteTest, GoesBackOnlyFromTheVersionThatWasMeant) {
  Site site = make();
  const std::string a = activated(site, "a");
  const std::string b = activated(site, "b");
  const std::string c = activated(site, "c");
  EXPECT_EQ(site.rollback(test::kAda, c).to, b);
  EXPECT_THAT(error_of([&] { (void)site.rollback(test::kAda, c); }),
              HasSubstr("another active version"));
  EXPECT_EQ(site.active(), b);
  EXPECT_EQ(site.rollback(test::kAda, b).to, a);
}

TEST_F(SiteTest, ActivatesOnlyInThePlaceOfTheVersionThatWasMeant) {
  Site site = make();
  const std::string a = activated(site, "a");
  const std::string b = activated(site, "b");
  const std::string c = add(site, "c");
  (void)site.rollback(test::kAda);
  const std::string before = test::bytes_of(at("hall") / kSiteFile);
  EXPECT_THAT(error_of([&] { site.approve(c, test::kAda, "seen", b); }),
              HasSubstr("another active version"));
  EXPECT_EQ(test::bytes_of(at("hall") / kSiteFile), before);
  EXPECT_THAT(states(site), ElementsAre("active", "retired", "candidate"));
  site.approve(c, test::kAda, "seen", a);
  for (const char* from : {b.c_str(), ""}) {
    EXPECT_THAT(error_of([&] { (void)site.activate(c, test::kAda, from); }),
                HasSubstr("another active version"));
    EXPECT_EQ(site.active(), a);
  }
  EXPECT_EQ(site.activate(c, test::kAda, a).from, a);
}

TEST_F(SiteTest, NeitherApprovesNorActivatesNorGoesBackToADamagedVersion) {
  Site site = make();
  const std::string a = activated(site, "a");
  const std::string b = activated(site, "b");
  const std::string c = add(site, "c");
  std::ofstream(site.maps_of(a) / "patches/submap0.pgm", std::ios::app) << "x";
  fs::remove(site.maps_of(c) / "summary.json");
  EXPECT_EQ(site.fault_of(a), "patches/submap0.pgm was changed");
  EXPECT_EQ(site.fault_of(b), "");
  EXPECT_EQ(site.fault_of(c), "summary.json is missing");
  EXPECT_THAT(error_of([&] { (void)site.rollback(test::kAda); }), HasSubstr("was changed"));
  EXPECT_THAT(error_of([&] { (void)site.activate(a, test::kAda); }),
              HasSubstr("hash does not hold"));
  EXPECT_THAT(error_of([&] { site.approve(c, test::kAda, ""); }), HasSubstr("is missing"));
  EXPECT_EQ(site.active(), b);
  EXPECT_THAT(states(site), ElementsAre("retired", "active", "candidate"));
}

// 50 of 50: any bit of any file of a version, its description included.
TEST_F(SiteTest, FindsEveryBitThatIsNotAsItWas) {
  Site site = make();
  const std::string hash = add(site, "a");
  const std::vector<fs::path> files = {site.maps_of(hash) / "strata.db",
                                       site.maps_of(hash) / "summary.json",
                                       site.maps_of(hash).parent_path() / "version.json"};
  for (int i = 0; i < 50; ++i) {
    const fs::path& file = files[static_cast<std::size_t>(i) % files.size()];
    const std::string whole = test::bytes_of(file);
    std::string other = whole;
    char& byte = other[static_cast<std::size_t>(i) * 997U % whole.size()];
    // White space of a JSON text may change without a change of what it says.
    byte = static_cast<char>(byte ^ (1 << (i % 7)));
    std::ofstream(file, std::ios::binary) << other;
    const bool is_only_space = file.filename() == "version.json" &&
                               site.versions()[0].fault.empty() && site.fault_of(hash).empty();
    if (is_only_space) {
      EXPECT_EQ(to_json(read_version(file)).dump(), to_json(site.versions()[0].version).dump());
    } else {
      EXPECT_NE(site.fault_of(hash), "") << file << " " << i;
      EXPECT_THROW(site.approve(hash, test::kAda, ""), InputError);
    }
    std::ofstream(file, std::ios::binary) << whole;
    EXPECT_EQ(site.fault_of(hash), "");
  }
}

TEST_F(SiteTest, TellsADescriptionThatIsCutAndGoesOnWithTheOthers) {
  Site site = make();
  (void)add(site, "a");
  const std::string b = add(site, "b");
  fs::resize_file(site.maps_of(b).parent_path() / "version.json", 40);
  ASSERT_EQ(site.versions().size(), 2U);
  EXPECT_EQ(site.versions()[1].version.hash, b);
  EXPECT_THAT(site.versions()[1].fault, HasSubstr("cut"));
  EXPECT_EQ(site.find("1").version.number, 1);
  const std::string c = add(site, "c");
  EXPECT_EQ(site.find(c).version.number, 3);
}

TEST_F(SiteTest, FindsVersionsByNumberBeginAndName) {
  Site site = make();
  const std::string a = activated(site, "a");
  const std::string b = add(site, "b");
  EXPECT_EQ(site.find("1").version.hash, a);
  EXPECT_EQ(site.find(b.substr(0, 8)).version.hash, b);
  EXPECT_EQ(site.find("active").version.hash, a);
  EXPECT_EQ(site.find("newest").version.hash, b);
  EXPECT_THAT(error_of([&] { (void)site.find("7"); }), HasSubstr("there are 1 ("));
  EXPECT_THAT(error_of([&] { (void)site.find("previous"); }), HasSubstr("no version"));
}

TEST_F(SiteTest, RefusesWhatIsNoWholeFolderOfMaps) {
  Site site = make();
  EXPECT_THROW((void)site.add(at("nothing"), test::kAda, ""), InputError);
  test::write_small_maps(at("bad"), "bad");
  fs::resize_file(at("bad") / "strata.db", 600);
  EXPECT_THROW((void)site.add(at("bad"), test::kAda, ""), InputError);
  // A bit that SQLite does not miss.
  test::write_small_maps(at("flipped"), "flipped");
  std::string bytes = test::bytes_of(at("flipped") / "strata.db");
  const std::size_t frame = bytes.find("\x28\xb5\x2f\xfd");  // where a blob begins
  ASSERT_NE(frame, std::string::npos);
  bytes[frame + 8] = static_cast<char>(bytes[frame + 8] ^ 1);
  std::ofstream(at("flipped") / "strata.db", std::ios::binary) << bytes;
  EXPECT_THAT(error_of([&] { (void)site.add(at("flipped"), test::kAda, ""); }),
              HasSubstr("content is damaged"));
  test::write_small_maps(at("busy"), "busy");
  std::ofstream(at("busy") / "strata.db-wal") << "not yet in the store";
  EXPECT_THAT(error_of([&] { (void)site.add(at("busy"), test::kAda, ""); }),
              HasSubstr("being written to"));
  EXPECT_TRUE(site.versions().empty());
}

TEST_F(SiteTest, IsNotMadeWhereSomethingIs) {
  (void)make();
  EXPECT_THAT(error_of([&] { (void)make(); }), HasSubstr("exists already"));
  EXPECT_THROW(Site{at("nothing")}, InputError);
  fs::resize_file(at("hall") / "site.json", 10);
  EXPECT_THAT(error_of([&] { Site{at("hall")}; }), HasSubstr("damaged"));
}

TEST_F(SiteTest, LosesNothingWhereADiskIsFull) {
  Site site = make();
  const std::string a = activated(site, "a");
  const std::string b = add(site, "b");
  site.approve(b, test::kAda, "seen");
  test::write_small_maps(at("maps-c"), "c");
  const std::string before = test::bytes_of(at("hall") / "site.json");
  {
    const test::FullDisk full(100);
    EXPECT_THROW((void)site.add(at("maps-c"), test::kAda, ""), OutputError);
    EXPECT_THROW((void)site.activate(b, test::kAda), OutputError);
    EXPECT_THROW(site.approve(b, test::kAda, ""), OutputError);
  }
  EXPECT_EQ(test::bytes_of(at("hall") / "site.json"), before);
  EXPECT_EQ(site.active(), a);
  EXPECT_THAT(states(site), ElementsAre("active", "approved"));
  std::size_t entries = 0;
  for (const auto& entry : fs::directory_iterator(at("hall") / "versions")) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry;
    ++entries;
  }
  EXPECT_EQ(entries, 2U);
  EXPECT_NO_THROW((void)site.activate(b, test::kAda));
}

}  // namespace
}  // namespace strata::site
