// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/versions.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/fleet/pull.hpp"
#include "components/log/content_hash.hpp"
#include "core/base/damage.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::fleet {
namespace {

using test::ada;
using test::drive;
using test::first_tour;
using testing::HasSubstr;
using testing::ThrowsMessage;

class ReleasedVersions : public test::FleetFixture {
 protected:
  /// Adds maps to the operator's site, approves them and releases them; the hash.
  std::string release_next(const std::string& name) const {
    test::write_maps(at(name), {first_tour(), drive(50, 3)}, name);
    site::Site local(at("hall-site"));
    const std::string hash = local.add(at(name), ada(), "").status.version.hash;
    local.approve(hash, ada(), "");
    Connection connection = as("hall.ada");
    release(connection, local, hash, name);
    return hash;
  }
  [[nodiscard]] site::Site robots_site() const {
    return site::Site::create(at("robot"), "hall", "map", ada());
  }
  [[nodiscard]] std::vector<std::string> names_in(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(at(folder))) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(ReleasedVersions, ComeToARobotsSiteAsTheyWere) {
  site::Site site = robots_site();
  Connection robot = as("hall.r1");
  EXPECT_FALSE(pull(robot, site, {}, ada())) << "nothing is released yet";
  const std::string hash = release_first_tour("hall");
  const auto pulled = pull(robot, site, {}, ada());
  ASSERT_TRUE(pulled);
  EXPECT_TRUE(pulled->is_new);
  EXPECT_EQ(pulled->status.version.hash, hash);
  EXPECT_EQ(pulled->status.state, site::VersionState::kCandidate);
  EXPECT_THAT(pulled->status.version.note, HasSubstr("released by hall.ada"));
  EXPECT_EQ(site.fault_of(hash), "");
  EXPECT_FALSE(pull(robot, site, {}, ada())->is_new);
  EXPECT_EQ(site.versions().size(), 1U);
  EXPECT_EQ(pull(robot, site, {.approve = true}, ada())->status.state,
            site::VersionState::kApproved);
  EXPECT_EQ(site.active(), std::nullopt);
  (void)pull(robot, site, {.approve = true, .activate = true}, ada());
  EXPECT_EQ(site.active(), hash);
  EXPECT_THAT(names_in("robot"), testing::ElementsAre("active", "site.json", "versions"));
}

TEST_F(ReleasedVersions, AreTakenBackForAllRobots) {
  const PullOptions use{.approve = true, .activate = true};
  const std::string first = release_first_tour("hall");
  const std::string second = release_next("second");
  site::Site site = robots_site();
  Connection robot = as("hall.r1");
  (void)pull(robot, site, use, ada());
  EXPECT_EQ(site.active(), second);
  Connection operators = as("hall.ada");
  withdraw(operators, "hall", second);
  EXPECT_THROW(withdraw(operators, "hall", second), InputError) << "it is already";
  (void)pull(robot, site, use, ada());
  EXPECT_EQ(site.active(), first);
  EXPECT_THAT([&] { fetch(robot, "hall", second, at("withdrawn")); },
              ThrowsMessage<InputError>(HasSubstr("has released no version")));
  release(operators, site::Site(at("hall-site")), second, "again");
  (void)pull(robot, site, use, ada());
  EXPECT_EQ(site.active(), second);
  EXPECT_EQ(versions(operators, "hall").size(), 2U);
}

/// A server whose clock was a year ahead when the second one came.
TEST_F(ReleasedVersions, CountInTheOrderOfTheirReleaseWhateverTheClockSaid) {
  const std::string first = release_first_tour("hall");
  const std::string second = release_next("second");
  Connection admin = server_->admin();
  (void)admin.query("SET session_replication_role = replica");  // no trigger tells the time
  (void)admin.query(
      "UPDATE strata.version SET state_at = state_at + interval '1 year' WHERE hash = $1",
      {second});
  Connection operators = as("hall.ada");
  Connection robot = as("hall.r1");
  release(operators, site::Site(at("hall-site")), first, "");
  EXPECT_EQ(newest_released(robot, "hall")->hash, first);
  const std::string third = release_next("third");
  EXPECT_EQ(newest_released(robot, "hall")->hash, third);
  const auto all = versions(robot, "hall");
  ASSERT_EQ(all.size(), 3U);
  EXPECT_LT(all[2].at, all[1].at);
  EXPECT_LT(all[1].at, all[0].at);
}

TEST_F(ReleasedVersions, StayAsTheyAreWhenTheyAreReleasedEveryNight) {
  const std::string first = release_first_tour("hall");
  Connection operators = as("hall.ada");
  const site::Site local(at("hall-site"));
  const auto newest = [&] { return newest_released(operators, "hall").value(); };
  const std::string at_first = newest().at;
  EXPECT_FALSE(release_once(operators, local, first, ""));
  EXPECT_EQ(newest().at, at_first) << "robots that went back would take it anew";
  const std::string second = release_next("second");
  EXPECT_THAT([&] { (void)release_once(operators, local, first, ""); },
              ThrowsMessage<InputError>(HasSubstr("another one was released")));
  EXPECT_EQ(newest().hash, second);
  withdraw(operators, "hall", second);
  EXPECT_THAT([&] { (void)release_once(operators, local, second, ""); },
              ThrowsMessage<InputError>(HasSubstr("it was withdrawn")));
  EXPECT_EQ(newest().hash, first);
  release(operators, local, second, "by hand");
  EXPECT_EQ(newest().hash, second);
}

TEST_F(ReleasedVersions, AreThoseThatWereApprovedByOperatorsOfThatSite) {
  (void)release_first_tour("hall");
  test::write_maps(at("more"), {first_tour()}, "more");
  site::Site local(at("hall-site"));
  const std::string candidate = local.add(at("more"), ada(), "").status.version.hash;
  Connection operators = as("hall.ada");
  EXPECT_THAT([&] { release(operators, local, candidate, ""); },
              ThrowsMessage<InputError>(HasSubstr("was not approved")));
  local.approve(candidate, ada(), "");
  Connection robot = as("hall.r1");
  EXPECT_THROW(release(robot, local, candidate, ""), DeniedError);
  Connection others = as("yard.ada");
  EXPECT_THAT([&] { release(others, local, candidate, ""); },
              ThrowsMessage<InputError>(HasSubstr("two sites do not mix")));
  EXPECT_EQ(versions(operators, "hall").size(), 1U);
}

TEST_F(ReleasedVersions, OfAnotherSiteOrFrameAreNotPulled) {
  (void)release_first_tour("hall");
  Connection robot = as("hall.r1");
  site::Site yard = site::Site::create(at("yard"), "yard", "map", ada());
  EXPECT_THAT([&] { (void)pull(robot, yard, {}, ada()); },
              ThrowsMessage<InputError>(HasSubstr("two sites do not mix")));
  site::Site turned = site::Site::create(at("turned"), "hall", "turned", ada());
  EXPECT_THAT([&] { (void)pull(robot, turned, {}, ada()); },
              ThrowsMessage<InputError>(HasSubstr("is in frame 'turned'")));
  EXPECT_TRUE(yard.versions().empty());
  EXPECT_TRUE(turned.versions().empty());
}

TEST_F(ReleasedVersions, ThatAreDamagedOnTheServerAreRefused) {
  const std::string hash = release_first_tour("hall");
  site::Site site = robots_site();
  Connection robot = as("hall.r1");
  Connection admin = server_->admin();
  const std::string where = " WHERE hash = '" + hash + "' AND path = 'summary.json'";
  (void)admin.query("UPDATE strata.version_file SET payload = payload || 'x'" + where);
  EXPECT_THROW((void)pull(robot, site, {.approve = true, .activate = true}, ada()), DamageError);
  (void)admin.query("UPDATE strata.version_file SET path = '../../evil'" + where);
  EXPECT_THAT([&] { (void)pull(robot, site, {}, ada()); },
              ThrowsMessage<DamageError>(HasSubstr("'../../evil'")));
  (void)admin.query("UPDATE strata.version_file SET path = '/tmp/evil' WHERE path LIKE '%evil'");
  EXPECT_THROW((void)pull(robot, site, {}, ada()), DamageError);
  EXPECT_FALSE(fs::exists("/tmp/evil"));
  (void)admin.query("DELETE FROM strata.version_file WHERE path LIKE '%evil'");
  EXPECT_THROW((void)pull(robot, site, {}, ada()), DamageError) << "a file is missing";
  EXPECT_TRUE(site.versions().empty());
  EXPECT_EQ(site.active(), std::nullopt);
  EXPECT_THAT(names_in("robot"), testing::ElementsAre("site.json", "versions"));
}

/// Over several parts, one of them exactly full.
TEST_F(ReleasedVersions, OfLargeFilesComeWhole) {
  (void)release_first_tour("hall");
  test::write_maps(at("large"), {first_tour()}, "large");
  for (const std::size_t bytes :
       {std::size_t{4} << 20U, (std::size_t{9} << 20U) + 17, std::size_t{0}}) {
    std::ofstream out(at("large") / ("file" + std::to_string(bytes)), std::ios::binary);
    for (std::size_t i = 0; i < bytes; ++i) out.put(static_cast<char>(i * 2'654'435'761U >> 13U));
  }
  site::Site local(at("hall-site"));
  const std::string hash = local.add(at("large"), ada(), "").status.version.hash;
  local.approve(hash, ada(), "");
  Connection operators = as("hall.ada");
  release(operators, local, hash, "");
  Connection robot = as("hall.r1");
  fetch(robot, "hall", hash, at("fetched"));
  EXPECT_EQ(log::hash_content(at("fetched")).hash, hash);
}

}  // namespace
}  // namespace strata::fleet
