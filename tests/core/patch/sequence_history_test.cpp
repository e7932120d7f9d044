// SPDX-License-Identifier: Apache-2.0
#include "core/patch/sequence_history.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/state_archive.hpp"
#include "core/random/stream.hpp"

namespace strata::patch {
namespace {

double sum_of_transitions(const SequenceHistory& history, std::uint32_t from, std::uint32_t to) {
  double sum = 0.0;
  for (const Transition& t : history.transitions()) {
    if (t.from == from && t.to == to) sum += t.count;
  }
  return sum;
}

TEST(SequenceHistory, KnowsWhatFollowedAndHowMuchLater) {
  SequenceHistory history;
  history.append(0.0);
  history.append(30.0);
  history.append(-5.0);  // runs whose stamps overlap
  history.append(70.0);
  EXPECT_EQ(history.counts(), std::vector<double>(4, 1.0));
  ASSERT_EQ(history.transitions().size(), 2U);
  EXPECT_EQ(history.transitions()[0].dt_s, 30.0);
  EXPECT_EQ(sum_of_transitions(history, 0, 1), 1.0);
  EXPECT_EQ(sum_of_transitions(history, 1, 2), 0.0);
  EXPECT_EQ(sum_of_transitions(history, 2, 3), 1.0);
}

// However many are pooled, in whatever order: nothing is lost, and little is kept.
TEST(SequenceHistory, PoolingKeepsEveryCountAndTransition) {
  RandomStream random(1, StreamId::kTest);
  SequenceHistory history;
  std::vector<int> state;  // of each entry
  int sequences = 0;
  double changes[2][2] = {};
  for (int last = -1; sequences < 2000; ++sequences) {
    const int now = random.bernoulli(0.1) ? 1 : 0;
    history.append(sequences == 0 ? 0.0 : random.exponential(0.01));
    state.push_back(now);
    if (last >= 0) changes[last][now] += 1.0;
    last = now;
    while (state.size() > 20) {
      // The two oldest of the more frequent one.
      const int most =
          2 * std::count(state.begin(), state.end(), 0) >= static_cast<std::ptrdiff_t>(state.size())
              ? 0
              : 1;
      const auto a = std::find(state.begin(), state.end(), most);
      const auto b = std::find(a + 1, state.end(), most);
      history.pool(static_cast<std::size_t>(a - state.begin()),
                   static_cast<std::size_t>(b - state.begin()));
      state.erase(a);
    }
  }
  ASSERT_EQ(history.size(), state.size());
  double all = 0.0;
  double found[2][2] = {};
  for (const double count : history.counts()) all += count;
  for (const Transition& t : history.transitions()) {
    ASSERT_LT(std::max(t.from, t.to), state.size());
    found[state[t.from]][state[t.to]] += t.count;
  }
  EXPECT_EQ(all, 2000.0);
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) EXPECT_EQ(found[a][b], changes[a][b]) << a << b;
  }
  EXPECT_LT(history.transitions().size(), 400U);
}

TEST(SequenceHistory, TimesOfUnlikeLengthStayApart) {
  SequenceHistory history;
  for (const double dt_s : {0.0, 1.0, 1.0, 1.5, 1000.0}) history.append(dt_s);
  while (history.size() > 1) history.pool(0, 1);
  ASSERT_EQ(history.transitions().size(), 2U);
  const Transition& brief = history.transitions()[0];
  EXPECT_EQ(brief.count, 3.0);
  EXPECT_NEAR(brief.dt_s, 3.5 / 3.0, 1e-12);
  EXPECT_EQ(history.transitions()[1].dt_s, 1000.0);
}

TEST(SequenceHistory, OfAWholeThatWasTwoKeepsWhoFollowedWhom) {
  SequenceHistory history;
  for (const double dt_s : {0.0, 10.0, 20.0}) history.append(dt_s);
  history.split(1, 0.5);
  SequenceHistory expected;
  for (const double dt_s : {0.0, 10.0, 0.5, 20.0}) expected.append(dt_s);
  EXPECT_EQ(history.counts(), expected.counts());
  ASSERT_EQ(history.transitions().size(), 3U);
  for (const Transition& t : expected.transitions()) {
    EXPECT_EQ(std::count(history.transitions().begin(), history.transitions().end(), t), 1)
        << t.from << " to " << t.to;
  }
}

TEST(SequenceHistory, KnowsOnHowManyDaysAndInWhichHours) {
  SequenceHistory history;
  constexpr double hour_s = 3600.0;
  for (const double hour : {8.5, 9.5, 30.0, 31.0, 24.0 * 7.0 + 1.0}) {
    history.append(history.size() == 0 ? 0.0 : hour_s, Stamp::from_seconds(hour_s * hour));
  }
  EXPECT_EQ(history.seen().days, 3);
  EXPECT_EQ(history.seen().weeks, 2);
  ASSERT_EQ(history.transitions().size(), 4U);
  EXPECT_EQ(history.transitions()[0].hour, 9);
  EXPECT_EQ(history.transitions()[3].hour, 1);
}

// As learners saved it before hours were kept.
TEST(SequenceHistory, WithoutHoursIsReadAndToldToBeAlike) {
  struct WithoutHour {
    std::uint32_t from;
    std::uint32_t to;
    double dt_s;
    double count;
  };
  SequenceHistory history;
  for (int i = 0; i < 3; ++i) {
    history.append(i == 0 ? 0.0 : 600.0, Stamp::from_seconds(1000.0 * i));
  }
  StateWriter writer;
  writer(history.counts());
  writer(std::vector<WithoutHour>{{0, 1, 600.0, 1.0}, {1, 2, 600.0, 1.0}});
  const std::vector<std::uint8_t> bytes = writer.take();
  StateReader reader(bytes, "the state");
  SequenceHistory read;
  SequenceHistory::state(read, reader, false);
  reader.expect_end();
  EXPECT_TRUE(history.is_alike_but_for_hours(read));
  EXPECT_EQ(read.transitions()[0].hour, Transition::kUnknownHour);
  read.pool(0, 1);
  EXPECT_FALSE(history.is_alike_but_for_hours(read));
}

TEST(SequenceHistory, OfTwoPlacesIsOneWithWhatWasForgottenLeftOut) {
  SequenceHistory a;
  for (const double dt_s : {0.0, 10.0, 20.0}) a.append(dt_s);
  SequenceHistory both(3);
  const std::vector<std::uint32_t> places{0, SequenceHistory::kGone, 2};
  both.add(a, places);
  EXPECT_EQ(both.counts(), (std::vector<double>{1.0, 0.0, 1.0}));
  EXPECT_TRUE(both.transitions().empty()) << "both went by the one that is gone";
  both.add(a, std::vector<std::uint32_t>{0, 1, 2});
  EXPECT_EQ(both.counts(), (std::vector<double>{2.0, 1.0, 2.0}));
  EXPECT_EQ(both.transitions().size(), 2U);
}

}  // namespace
}  // namespace strata::patch
