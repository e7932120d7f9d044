// SPDX-License-Identifier: Apache-2.0
/// Releases that a robot cannot use, and what is left of those that it used.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "components/log/content_hash.hpp"
#include "tests/components/fleet_member/member_fixture.hpp"
#include "tests/memory/store/execute_sql.hpp"

namespace fs = std::filesystem;

namespace strata::fleet_member {
namespace {

using test::drive;

class UnusableRelease : public test::MemberFixture {
 protected:
  static constexpr int kLooks = 10;

  void SetUp() override {
    MemberFixture::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    fleet::Connection admin = server_->admin();
    admin.script("ALTER ROLE \"hall.r1\" SET log_statement = 'all'");
  }
  /// As an operator of another Strata would; its hash.
  std::string release_folder(const fs::path& folder) const {
    const log::HashedContent content = log::hash_content(folder);
    fleet::Connection ada = as("hall.ada");
    (void)ada.query(
        "INSERT INTO strata.version (site, hash, runs, facts, note) VALUES ('hall', $1, '{}', "
        "'{}', '')",
        {content.hash});
    for (const log::HashedFile& file : content.files) {
      std::ifstream in(folder / file.path, std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(in), {}};
      (void)ada.query(
          "INSERT INTO strata.version_file (site, hash, path, part, payload) VALUES ('hall', $1, "
          "$2, 0, $3)",
          {content.hash, file.path, std::as_bytes(std::span(bytes))});
    }
    (void)ada.query("UPDATE strata.version SET state = 'released' WHERE hash = $1", {content.hash});
    return content.hash;
  }
  /// How often the robot began to fetch a version.
  [[nodiscard]] std::size_t fetches() const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(server_->folder() / "data" / "log")) {
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        if (line.find("SELECT DISTINCT path FROM strata.version_file") != std::string::npos) {
          ++count;
        }
      }
    }
    return count;
  }
  /// Of a robot that is up to date when the release comes.
  void expect_one_fetch_of(const std::string& hash, const std::string& trouble) {
    const std::size_t before = fetches();
    EXPECT_TRUE(comes_to_say("message", trouble));
    for (int look = 0; look < kLooks && !HasFailure(); ++look) wait_for_a_look();
    EXPECT_EQ(fetches(), before + 1);
    EXPECT_NE(told("message").find(trouble), std::string::npos) << "it is still told";
    EXPECT_EQ(told("level"), "1");
    EXPECT_EQ(told("failures in a row"), "0") << "the server is well";
    EXPECT_NE(active(), hash);
    learn({drive(10, 1)});
    EXPECT_TRUE(test::comes_true([&] { return there().size() == 1; })) << "visits go on";
  }
  void start_up_to_date() {
    start();
    ASSERT_TRUE(comes_to_be("version pulled", newest()));
  }
  /// The robot does not see it whole.
  std::string release_damaged(std::int64_t begin_s) const {
    fleet::Connection admin = server_->admin();
    (void)admin.query("ALTER ROLE \"hall.r1\" NOLOGIN");
    (void)admin.query(
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE usename = 'hall.r1'");
    const std::string hash = release(begin_s);
    (void)admin.query(
        "UPDATE strata.version_file SET payload = payload || 'x' WHERE path = 'summary.json' AND "
        "hash = $1",
        {hash});
    (void)admin.query("ALTER ROLE \"hall.r1\" LOGIN");
    return hash;
  }
};

TEST_F(UnusableRelease, OfANewerStrataIsFetchedOnce) {
  ASSERT_NO_FATAL_FAILURE(start_up_to_date());
  test::write_maps(at("newer"), {test::first_tour()}, "newer");
  test::execute(at("newer") / maps::kStoreFile, "PRAGMA user_version = 1000");
  expect_one_fetch_of(release_folder(at("newer")), "newer");
}

/// One of its files stands where another's folder should: as on a full disk nothing can be written.
TEST_F(UnusableRelease, ThatCannotBeWrittenIsFetchedOnceAndIsNotTheServersFault) {
  ASSERT_NO_FATAL_FAILURE(start_up_to_date());
  test::write_maps(at("odd"), {test::first_tour()}, "odd");
  fleet::Connection ada = as("hall.ada");
  (void)ada.query(
      "INSERT INTO strata.version (site, hash, runs, facts, note) VALUES ('hall', repeat('a', 64), "
      "'{}', '{}', '')");
  for (const char* path : {"strata.db", "strata.db/more"}) {
    (void)ada.query(
        "INSERT INTO strata.version_file (site, hash, path, part, payload) VALUES ('hall', "
        "repeat('a', 64), $1, 0, 'x')",
        {path});
  }
  (void)ada.query("UPDATE strata.version SET state = 'released' WHERE hash = repeat('a', 64)");
  expect_one_fetch_of(std::string(64, 'a'), "cannot be written");
}

TEST_F(UnusableRelease, ThatIsDamagedIsFetchedOnce) {
  ASSERT_NO_FATAL_FAILURE(start_up_to_date());
  expect_one_fetch_of(release_damaged(500), "its hash does not hold");
}

TEST_F(UnusableRelease, IsTriedAgainAndDoesNotHoldUpTheNext) {
  start(", unusable: {first_s: 0.05, longest_s: 0.1}");
  const std::string first = newest();
  ASSERT_TRUE(test::comes_true([&] { return active() == first; }));
  const std::string second = release_damaged(500);
  EXPECT_TRUE(comes_to_say("message", "its hash does not hold"));
  const std::size_t before = fetches();
  EXPECT_TRUE(test::comes_true([&] { return fetches() > before + 1; })) << "it may be mended";
  fleet::Connection admin = server_->admin();
  (void)admin.query(
      "UPDATE strata.version_file SET payload = substr(payload, 1, octet_length(payload) - 1) "
      "WHERE path = 'summary.json' AND hash = $1",
      {second});
  EXPECT_TRUE(test::comes_true([&] { return active() == second; }));
  EXPECT_TRUE(comes_to_be("message", "OK"));
}

TEST_F(UnusableRelease, WaitsWhileTheNextIsUsedAtOnce) {
  start();
  const std::string first = newest();
  ASSERT_TRUE(test::comes_true([&] { return active() == first; }));
  (void)release_damaged(500);
  EXPECT_TRUE(comes_to_say("message", "its hash does not hold"));
  const std::string third = release(600);
  EXPECT_TRUE(test::comes_true([&] { return active() == third; }));
  EXPECT_TRUE(comes_to_be("message", "OK"));
}

class OldVersions : public test::MemberFixture {
 protected:
  [[nodiscard]] std::size_t kept() const { return site::Site(at("robot")).versions().size(); }
};

TEST_F(OldVersions, GoWhenOthersTookTheirPlace) {
  constexpr int kReleases = 12;
  site::Site robots(at("robot"));
  test::write_maps(at("own"), {test::first_tour(), drive(900, 4)}, "own");
  const std::string own = robots.add(at("own"), test::ada(), "").status.version.hash;
  start();
  const std::string first = newest();
  ASSERT_TRUE(test::comes_true([&] { return active() == first; }));
  for (int i = 0; i < kReleases; ++i) {
    const std::string next = release(500 + 10 * i);
    ASSERT_TRUE(comes_to_be("version pulled", next));
  }
  EXPECT_TRUE(test::comes_true([&] { return kept() <= 8; })) << kept();
  EXPECT_EQ(kept(), 8U) << "the active one, five before it, the first, and the robot's own";
  EXPECT_EQ(active(), newest());
  EXPECT_TRUE(robots.has(first));
  EXPECT_EQ(robots.find(own).state, site::VersionState::kCandidate);
  EXPECT_EQ(told("level"), "0");
}

TEST_F(OldVersions, ThatSomebodyWentBackFromStay) {
  start(", keep_retired: 0");
  const std::string first = newest();
  ASSERT_TRUE(test::comes_true([&] { return active() == first; }));
  const std::string second = release(500);
  ASSERT_TRUE(comes_to_be("version pulled", second));
  (void)site::Site(at("robot")).rollback(test::ada());
  const std::string third = release(600);
  ASSERT_TRUE(comes_to_be("version pulled", third));
  const std::string fourth = release(700);
  ASSERT_TRUE(comes_to_be("version pulled", fourth));
  EXPECT_TRUE(test::comes_true([&] { return kept() == 3; }));
  EXPECT_TRUE(site::Site(at("robot")).has(second));
  EXPECT_FALSE(site::Site(at("robot")).has(third));
}

}  // namespace
}  // namespace strata::fleet_member
