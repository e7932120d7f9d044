// SPDX-License-Identifier: Apache-2.0
/// `kill -9` of the whole server in the middle of a push: what was told to be sent is there, the
/// rest comes with the next push, and nothing comes twice.
#include <chrono>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "components/fleet/push.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::fleet {
namespace {

class ServerKilled : public test::FleetFixture {
 protected:
  static constexpr int kVisits = 12;

  void SetUp() override {
    FleetFixture::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    (void)release_first_tour("hall");
    std::vector<std::vector<PosedScan>> drives{test::first_tour()};
    // Half a megabyte each, so that a moment may fall into one.
    for (int i = 0; i < kVisits; ++i) drives.push_back(test::drive(100 + 10 * i, 1, 8000));
    test::write_maps(at("maps"), drives);
    for (const std::string& hash : run_hashes(at("maps"))) all_.insert(hash);
    all_.erase(visit_hash(0));
  }
  [[nodiscard]] std::string visit_hash(std::size_t run) const {
    return run_hashes(at("maps"))[run];
  }
  /// Pushes until the end or until the server is gone; what was told to be there.
  std::set<std::string> push_once(const std::function<void(std::size_t)>& after) const {
    std::set<std::string> told;
    try {
      Connection robot = as("hall.r1");
      push(robot, "hall", at("maps"), [&](const PushedVisit& visit) {
        EXPECT_NE(visit.outcome, PushOutcome::kClash);
        if (visit.outcome != PushOutcome::kReleased) told.insert(visit.name.sha256);
        after(told.size());
      });
    } catch (const LostError&) {  // as it should be told
    }
    return told;
  }
  [[nodiscard]] std::multiset<std::string> there() const {
    Connection ada = as("hall.ada");
    std::multiset<std::string> hashes;
    for_each_visit(ada, "hall", {},
                   [&](const VisitName& name, const std::vector<PosedScan>& scans) {
                     EXPECT_EQ(scans.size(), 20U) << "whole";
                     hashes.insert(name.sha256);
                   });
    return hashes;
  }
  void expect_all_once() const {
    (void)push_once([](std::size_t) {});
    const std::multiset<std::string> found = there();
    EXPECT_EQ(std::set(found.begin(), found.end()), all_);
    EXPECT_EQ(found.size(), all_.size()) << "none twice";
  }
  std::set<std::string> all_;
};

TEST_F(ServerKilled, BetweenTwoVisitsLosesNothing) {
  for (std::size_t after = 1; after <= 5; after += 2) {
    const auto told = push_once([&](std::size_t count) {
      if (count == after + 2) server_->kill_hard();
    });
    server_->start();
    const std::multiset<std::string> found = there();
    for (const std::string& hash : told) EXPECT_EQ(found.count(hash), 1U) << "it was acknowledged";
  }
  expect_all_once();
}

TEST_F(ServerKilled, AtAnyMomentLosesNothing) {
  for (const int moment_ms : {5, 20, 45, 80}) {
    std::jthread killer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(moment_ms));
      server_->kill_hard();
    });
    const auto told = push_once([](std::size_t) {});
    killer.join();
    server_->start();
    const std::multiset<std::string> found = there();
    for (const std::string& hash : told) {
      EXPECT_EQ(found.count(hash), 1U) << moment_ms << " ms: it was acknowledged";
    }
    EXPECT_LE(found.size(), all_.size());
  }
  expect_all_once();
}

/// The network, not the server.
TEST_F(ServerKilled, ConnectionsThatAreCutLoseNothing) {
  for (std::size_t after = 2; after <= 6; after += 2) {
    (void)push_once([&](std::size_t count) {
      if (count != after) return;
      Connection admin = server_->admin();
      (void)admin.query(
          "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE usename = 'hall.r1'");
    });
  }
  expect_all_once();
}

/// Holds up whoever writes to a table, and kills the server when somebody waits for that.
class KillWhileItWrites {
 public:
  KillWhileItWrites(test::PostgresServer& server, const std::string& table)
      : holder_(server.admin()), watcher_(server.admin()) {
    (void)holder_.query("BEGIN");
    (void)holder_.query("LOCK TABLE " + table + " IN SHARE MODE");
    killer_ = std::jthread([this, &server] {
      EXPECT_TRUE(test::comes_true([&] {
        return watcher_.query("SELECT FROM pg_stat_activity WHERE wait_event_type = 'Lock'")
                   .size() > 0;
      }));
      server.kill_hard();
    });
  }

 private:
  Connection holder_;
  Connection watcher_;
  std::jthread killer_;
};

TEST_F(ServerKilled, WhileItTakesAVisitLosesNothing) {
  std::set<std::string> told;
  {
    const KillWhileItWrites killer(*server_, "strata.visit");
    told = push_once([](std::size_t) {});
  }
  server_->start();
  EXPECT_LT(told.size(), all_.size());
  const std::multiset<std::string> found = there();
  for (const std::string& hash : told) EXPECT_EQ(found.count(hash), 1U) << "it was acknowledged";
  expect_all_once();
}

/// A release is in one transaction: a version is there as a whole or not at all.
TEST_F(ServerKilled, InTheMiddleOfAReleaseLeavesNoHalfVersion) {
  site::Site local(at("hall-site"));
  const std::string hash = local.add(at("maps"), test::ada(), "").status.version.hash;
  local.approve(hash, test::ada(), "");
  {
    const KillWhileItWrites killer(*server_, "strata.version_file");
    Connection ada = as("hall.ada");
    EXPECT_THROW(release(ada, local, hash, ""), LostError);
  }
  server_->start();
  Connection admin = server_->admin();
  EXPECT_EQ(admin.query("SELECT FROM strata.version").size(), 1U) << "that of the first tour";
  EXPECT_EQ(admin.query("SELECT FROM strata.version_file WHERE hash = $1", {hash}).size(), 0U);
  Connection ada = as("hall.ada");
  release(ada, local, hash, "");
  fetch(ada, "hall", hash, at("fetched"));
}

}  // namespace
}  // namespace strata::fleet
