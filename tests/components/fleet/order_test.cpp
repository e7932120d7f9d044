// SPDX-License-Identifier: Apache-2.0
/// Merging is commutative and associative: whoever pushed first, and in whatever groups, what is
/// learned is the same bit for bit.
#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "components/fleet/push.hpp"
#include "components/fleet/visits.hpp"
#include "components/log/sha256.hpp"
#include "memory/store/coded_visit.hpp"
#include "memory/store/visit_content.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"

namespace strata::fleet {
namespace {

constexpr std::size_t kRounds = 100;

/// A folder that a robot pushes: some of its visits, in some order.
struct Group {
  std::size_t robot = 0;
  std::vector<std::vector<PosedScan>> drives;
};

class Order : public test::FleetFixture {
 protected:
  [[nodiscard]] std::size_t below(std::size_t count) {
    return std::min(count - 1,
                    static_cast<std::size_t>(random_.uniform() * static_cast<double>(count)));
  }
  template <class T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(i)]);
  }
  /// All visits of all robots, each in at least one group.
  [[nodiscard]] std::vector<Group> random_groups() {
    std::vector<Group> groups;
    for (std::size_t robot = 0; robot < drives_.size(); ++robot) {
      std::vector<std::vector<PosedScan>> own = drives_[robot];
      shuffle(own);
      groups.push_back({robot, {}});
      for (const auto& drive : own) {
        if (!groups.back().drives.empty() && below(2) == 0) groups.push_back({robot, {}});
        groups.back().drives.push_back(drive);
      }
      // As a folder that goes on from maps with visits that were pushed already.
      if (below(2) == 0) groups.back().drives.push_back(own[below(own.size())]);
    }
    shuffle(groups);
    return groups;
  }
  void push_all(std::vector<Connection>& robots, const std::vector<Group>& groups) {
    for (const Group& group : groups) {
      std::vector<std::vector<PosedScan>> runs = group.drives;
      runs.insert(runs.begin() + static_cast<std::ptrdiff_t>(below(runs.size() + 1)),
                  test::first_tour());
      std::filesystem::remove_all(at("maps"));
      test::write_maps(at("maps"), runs);
      push(
          robots[group.robot], "hall", at("maps"),
          [](const PushedVisit& visit) { EXPECT_NE(visit.outcome, PushOutcome::kClash); }, {},
          coding_ ? &*coding_ : nullptr);
    }
  }
  /// Whose visit, its number and every bit of it, in the order they are learned in.
  [[nodiscard]] static std::vector<std::byte> bits_of(const std::vector<LearnedVisit>& visits) {
    std::vector<std::byte> all;
    for (const LearnedVisit& visit : visits) {
      for (const char c : visit.name.robot + visit.name.sha256) {
        all.push_back(static_cast<std::byte>(c));
      }
      const auto content = memory::visit_content(visit.scans);
      all.insert(all.end(), content.begin(), content.end());
    }
    return all;
  }
  void forget_visits() const {
    Connection admin = server_->admin();
    (void)admin.query("SET session_replication_role = replica");  // no trigger forbids it
    (void)admin.query("DELETE FROM strata.visit");
  }
  void expect_the_same_bits_in_any_order();
  std::optional<Coding> coding_;  // visits are told relative to it
  RandomStream random_{31, StreamId::kTest};
  std::vector<std::vector<std::vector<PosedScan>>> drives_;  // of each robot
};

void Order::expect_the_same_bits_in_any_order() {
  add_robot("hall", "r3");
  std::vector<LearnedVisit> expected;
  for (std::uint64_t robot = 0; robot < 3; ++robot) {
    drives_.emplace_back();
    for (const std::int64_t begin_s : {100, 200, 300, 400}) {
      // Robots begin some drives at the same nanosecond.
      const std::int64_t own_s = begin_s == 200 ? begin_s : begin_s + static_cast<int>(7 * robot);
      drives_.back().push_back(test::drive(own_s, robot + 1, 30));
      std::vector<PosedScan> scans = drives_.back().back();
      if (coding_) {
        auto coded = memory::code_visit(scans, coding_->map, coding_->hash, 0.05);
        scans = std::move(coded.value().scans);
      }
      expected.push_back(
          {{"r" + std::to_string(robot + 1), scans.front().scan.stamp.ns, log::sha256_of([&] {
              const auto content = memory::visit_content(scans);
              return std::string(reinterpret_cast<const char*>(content.data()), content.size());
            }())},
           scans});
    }
  }
  std::sort(expected.begin(), expected.end(), [](const LearnedVisit& a, const LearnedVisit& b) {
    return std::tie(a.name.number, a.name.robot) < std::tie(b.name.number, b.name.robot);
  });
  const std::vector<std::byte> bits = bits_of(expected);
  std::vector<Connection> robots;
  for (const char* robot : {"hall.r1", "hall.r2", "hall.r3"}) robots.push_back(as(robot));
  Connection ada = as("hall.ada");
  for (std::size_t round = 0; round < kRounds; ++round) {
    push_all(robots, random_groups());
    ASSERT_EQ(bits_of(visits_to_learn(ada, "hall", {})) == bits, true) << "round " << round;
    forget_visits();
  }
}

TEST_F(Order, AndGroupsOfPushesMakeNoDifferenceToWhatIsLearned) {
  (void)release_first_tour("hall");
  expect_the_same_bits_in_any_order();
}

TEST_F(Order, MakesNoDifferenceWhereVisitsAreToldRelativeToAVersion) {
  const std::string hash = release_first_tour("hall");
  coding_ = Coding{hash, maps::open_for_reading(at("hall-first")).load_reflection_grid("filtered")};
  expect_the_same_bits_in_any_order();
}

}  // namespace
}  // namespace strata::fleet
