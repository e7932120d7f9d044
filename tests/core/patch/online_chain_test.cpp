// SPDX-License-Identifier: Apache-2.0
/// A door that is seldom open, passed so often that most sequences were pooled: how often it is
/// open, and how fast it moves, is still known.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch/chain.hpp"
#include "core/patch/online_learner.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch {
namespace {

/// So many take 10 s of CPU time; STRATA_CHAIN_VISITS asks for more.
constexpr int kVisits = 400;
int visits() {
  const char* const asked = std::getenv("STRATA_CHAIN_VISITS");
  return asked != nullptr ? std::max(kVisits, std::atoi(asked)) : kVisits;
}
constexpr double kGap_s = 600.0;  // the mean, from one visit to the next
constexpr double kRate_per_s = 1.0 / 600.0;

/// The map that was learned.
struct Year {
  PatchMap map;
  std::size_t pooled = 0;
  Chain truth;  ///< what all visits together say, none of them pooled
};

/// The chain that draws the door anew at kRate_per_s, open with the probability given.
Year a_year(double open, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest);
  test_world::ToyRobot robot;
  robot.beams = 90;
  const auto pass = [&](bool is_open, double start_s, std::vector<PosedScan>& scans) {
    const double y = random.uniform(1.1, 1.4);
    robot.drive(test_world::corridor_with_door(!is_open), {5.3, y, 0.0}, {5.75, y, 0.0}, 0, start_s,
                {}, random, scans);
  };
  std::vector<PosedScan> first;
  pass(false, 0.0, first);
  OnlineConfig config;
  config.check_every_s = 50.0 * kGap_s;  // a look over the whole place takes the most time
  config.max_sequences = 12;
  OnlinePatchLearner learner({}, config, test_world::map_of(first));
  bool is_open = random.bernoulli(open);
  double now_s = 0.0;
  Year year;
  const int count = visits();
  std::vector<std::vector<double>> looks;
  SequenceHistory history;
  for (int v = 0; v < count; ++v) {
    const double gap_s = 20.0 + random.exponential(1.0 / (kGap_s - 20.0));
    if (!random.bernoulli(std::exp(-kRate_per_s * gap_s))) is_open = random.bernoulli(open);
    now_s += gap_s;
    looks.push_back({is_open ? 0.0 : 1.0, is_open ? 1.0 : 0.0});
    history.append(v == 0 ? 0.0 : gap_s);
    std::vector<PosedScan> scans;
    pass(is_open, now_s, scans);
    for (PosedScan& scan : scans) (void)learner.add(std::move(scan));
  }
  year.truth = learn_chain(looks, history, {});
  year.map = learner.finish();
  year.pooled = learner.status().pooled_sequences;
  return year;
}

// Above the limit the two oldest of the more frequent configuration counted as one, so that the
// shares of both became 0.5; and a chain with even odds takes the rate for a tenth.
TEST(OnlineChain, OfADoorThatIsSeldomOpenIsKnownHoweverManySequencesWerePooled) {
  for (const double open : {0.043, 0.094}) {
    const Year year = a_year(open, 3);
    EXPECT_GT(year.pooled, 300U);
    ASSERT_EQ(year.map.submaps.size(), 1U) << open;
    const Submap& door = year.map.submaps[0];
    ASSERT_EQ(door.configurations.size(), 2U) << open;
    const double rare = std::min(door.configurations[0].prior, door.configurations[1].prior);
    EXPECT_NEAR(rare / year.truth.usual[1], 1.0, 0.05) << open;
    EXPECT_NEAR(door.change_rate_per_s / year.truth.rate_per_s, 1.0, 0.05) << open;
    const double opening_per_s = door.change_rate_per_s * rare;
    const double closing_per_s = door.change_rate_per_s * (1.0 - rare);
    // Someone who knows the map and did not look: nats a look, by the shares that are true.
    const double score = -open * std::log(rare) - (1.0 - open) * std::log(1.0 - rare);
    EXPECT_LE(score, open < 0.05 ? 0.20 : 0.33) << open;
    RecordProperty("opening", std::to_string(opening_per_s / (kRate_per_s * open)));
    RecordProperty("closing", std::to_string(closing_per_s / (kRate_per_s * (1.0 - open))));
    if (visits() < 2000) continue;  // chance alone is more than a fifth
    EXPECT_NEAR(opening_per_s / (kRate_per_s * open), 1.0, 0.2) << open;
    EXPECT_NEAR(closing_per_s / (kRate_per_s * (1.0 - open)), 1.0, 0.2) << open;
  }
}

}  // namespace
}  // namespace strata::patch
