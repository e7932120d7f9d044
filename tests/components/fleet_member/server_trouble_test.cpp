// SPDX-License-Identifier: Apache-2.0
/// Servers that are down, killed, slow or full: nothing is lost, nothing comes twice, and nobody on
/// the robot waits.
#include <algorithm>
#include <cstdint>
#include <set>
#include <string>

#include "tests/components/fleet_member/member_fixture.hpp"

namespace strata::fleet_member {
namespace {

using test::drive;

class ServerTrouble : public test::MemberFixture {
 protected:
  static constexpr std::size_t kVisits = 8;

  void SetUp() override {
    MemberFixture::SetUp();
    if (!IsSkipped() && !HasFatalFailure()) learn(drives(kVisits));
  }
  [[nodiscard]] static std::vector<std::vector<PosedScan>> drives(std::size_t count) {
    std::vector<std::vector<PosedScan>> all;
    for (std::size_t i = 0; i < count; ++i) {
      all.push_back(drive(100 + 10 * static_cast<std::int64_t>(i), 1));
    }
    return all;
  }
  void expect_all_once(std::size_t count) {
    EXPECT_TRUE(test::comes_true([&] { return there().size() >= count; }));
    std::set<std::string> hashes;
    for (const fleet::VisitName& name : there()) hashes.insert(name.sha256);
    std::vector<std::string> local = fleet::run_hashes(at("maps"));
    local.erase(local.begin());  // the first tour
    EXPECT_EQ(hashes, std::set<std::string>(local.begin(), local.end()));
    EXPECT_EQ(there().size(), count) << "none twice";
    EXPECT_TRUE(comes_to_say("message", "OK"));
    EXPECT_TRUE(comes_to_be("visits waiting", "0"));
  }
  /// While it lives nobody can write visits.
  class Locked {
   public:
    explicit Locked(const test::PostgresServer& server) : holder_(server.admin()) {
      (void)holder_.query("BEGIN");
      (void)holder_.query("LOCK TABLE strata.visit IN SHARE MODE");
    }

   private:
    fleet::Connection holder_;
  };
  /// Processes of the server whose statements wait for the lock.
  [[nodiscard]] std::set<std::int64_t> waiting() const {
    fleet::Connection admin = server_->admin();
    std::set<std::int64_t> pids;
    const auto rows =
        admin.query("SELECT pid FROM pg_stat_activity WHERE wait_event_type = 'Lock'");
    for (std::size_t i = 0; i < rows.size(); ++i) pids.insert(rows.integer(i, 0));
    return pids;
  }
};

TEST_F(ServerTrouble, StartedLaterGetsAllThatWaits) {
  server_->kill_hard();
  start();
  EXPECT_TRUE(comes_to_say("message", "cannot be reached"));
  EXPECT_NE(told("message").find("check that the server runs"), std::string::npos) << "the remedy";
  EXPECT_EQ(told("level"), "1") << "the robot drives on";
  EXPECT_EQ(told("visits waiting"), "9") << "nobody knows yet that the first tour was released";
  EXPECT_EQ(told("last push, s ago"), "never");
  EXPECT_TRUE(test::comes_true([&] { return std::atoi(told("failures in a row").c_str()) >= 3; }));
  server_->start();
  expect_all_once(kVisits);
  EXPECT_EQ(told("failures in a row"), "0");
  EXPECT_NE(told("last error").find("cannot be reached"), std::string::npos);
  EXPECT_NE(active(), "none");
}

TEST_F(ServerTrouble, KilledWhileItTakesAVisitLosesNothing) {
  {
    const Locked locked(*server_);
    start();
    EXPECT_TRUE(test::comes_true([&] { return !waiting().empty(); }));
    server_->kill_hard();
  }
  EXPECT_TRUE(comes_to_say("level", "1"));
  server_->start();
  expect_all_once(kVisits);
}

TEST_F(ServerTrouble, KilledAndBackAgainAndAgainLosesNothing) {
  start();
  for (std::size_t count = kVisits; count < kVisits + 4; ++count) {
    EXPECT_TRUE(test::comes_true([&] { return there().size() == count; }));
    server_->kill_hard();
    learn(drives(count + 1));
    EXPECT_TRUE(comes_to_say("visits waiting", "1"));
    server_->start();
  }
  expect_all_once(kVisits + 4);
  EXPECT_EQ(told("visits sent"), std::to_string(kVisits + 4)) << "each once";
}

/// A drive every ten minutes for 24 hours, learned night by night, and no network.
TEST_F(ServerTrouble, OfADayLosesNothing) {
  constexpr std::size_t kDay = 144;
  server_->kill_hard();
  start();
  for (std::size_t count = 36; count <= kDay; count += 36) {
    learn(drives(count));
    EXPECT_TRUE(comes_to_be("visits waiting", std::to_string(count + 1))) << "and the first tour";
  }
  server_->start();
  expect_all_once(kDay);
  EXPECT_TRUE(comes_to_be("visits sent", std::to_string(kDay)));
}

/// From a backup of before: what is not there comes again.
TEST_F(ServerTrouble, AnOlderCopyOfTheServerGetsAll) {
  start();
  expect_all_once(kVisits);
  {
    fleet::Connection admin = server_->admin();
    (void)admin.query("SET session_replication_role = replica");  // no trigger forbids it
    (void)admin.query("DELETE FROM strata.visit");
  }
  server_->kill_hard();
  EXPECT_TRUE(comes_to_be("level", "1"));
  server_->start();
  expect_all_once(kVisits);
}

TEST_F(ServerTrouble, CutOffLosesNothing) {
  start();
  for (int i = 0; i < 5; ++i) {
    fleet::Connection admin = server_->admin();
    (void)admin.query(
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE usename = 'hall.r1'");
  }
  expect_all_once(kVisits);
}

TEST_F(ServerTrouble, SlowIsTold) {
  {
    const Locked locked(*server_);
    start(", timeout_s: 1.0");
    EXPECT_TRUE(comes_to_say("message", "took longer than 1 s"));
  }
  expect_all_once(kVisits);
}

TEST_F(ServerTrouble, FullIsTold) {
  fleet::Connection admin = server_->admin();
  admin.script(
      "CREATE FUNCTION public.full_disk() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN RAISE "
      "EXCEPTION 'No space left on device' USING ERRCODE = '53100'; END $$;"
      "CREATE TRIGGER full_disk BEFORE INSERT ON strata.visit EXECUTE FUNCTION "
      "public.full_disk()");
  start();
  EXPECT_TRUE(comes_to_say("message", "is short of disk"));
  EXPECT_TRUE(there().empty());
  admin.script("DROP TRIGGER full_disk ON strata.visit");
  expect_all_once(kVisits);
}

TEST_F(ServerTrouble, APasswordThatIsMendedIsTaken) {
  setenv("PGPASSWORD", "wrong", 1);
  start();
  EXPECT_TRUE(comes_to_say("message", "check user, password and database"));
  setenv("PGPASSWORD", test::kPassword, 1);
  expect_all_once(kVisits);
}

TEST_F(ServerTrouble, ThatHangsDoesNotHoldUpTheEndOfTheProcess) {
  {
    const Locked locked(*server_);
    start();
    ASSERT_TRUE(test::comes_true([&] { return !waiting().empty(); }));
    host_.reset();
    EXPECT_FALSE(waiting().empty()) << "the end came with the statement's";
  }
  start();
  expect_all_once(kVisits);
}

TEST_F(ServerTrouble, ThatHangsHoldsUpNobodyOnTheRobot) {
  {
    const Locked locked(*server_);
    start();
    ASSERT_TRUE(test::comes_true([&] { return !waiting().empty(); }));
    const std::set<std::int64_t> before = waiting();
    for (int i = 0; i < 10; ++i) host_->tick();
    member().deactivate();
    member().activate();
    member().deactivate();
    member().cleanup();
    member().configure();
    member().activate();
    const auto waits_still = [&] {
      const std::set<std::int64_t> now = waiting();
      return std::includes(now.begin(), now.end(), before.begin(), before.end());
    };
    EXPECT_TRUE(waits_still()) << "all this came after the statement's end";
    EXPECT_TRUE(test::comes_true([&] { return waiting().size() > before.size(); }))
        << "it tries again";
  }
  expect_all_once(kVisits);
}

}  // namespace
}  // namespace strata::fleet_member
