// SPDX-License-Identifier: Apache-2.0
#include "core/patch/recurrence.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::patch {
namespace {

using Looks = std::vector<std::vector<double>>;

/// What each of the letters looks like; '?': the sequence does not tell.
Looks looks_of(const std::string& seen) {
  Looks looks;
  for (const char letter : seen) {
    std::vector<double> look(4, letter == '?' ? 0.25 : 0.01);
    if (letter != '?') look[static_cast<std::size_t>(letter - 'a')] = 0.97;
    looks.push_back(look);
  }
  return looks;
}

SequenceHistory history_of_length(std::size_t sequences) {
  SequenceHistory history;
  for (std::size_t i = 0; i < sequences; ++i) history.append(i == 0 ? 0.0 : 60.0);
  return history;
}

Recurrence recurrence(const std::string& seen) {
  return recurrence_of(looks_of(seen), history_of_length(seen.size()));
}

TEST(Recurrence, CountsWhatCameInPlaceOfTheUsual) {
  EXPECT_EQ(recurrence("aaabaacaada"), (Recurrence{3.0, 3.0}));
  EXPECT_EQ(recurrence("aaabaabaaba"), (Recurrence{3.0, 1.0}));
  EXPECT_EQ(recurrence("ababab"), (Recurrence{3.0, 1.0}));
  EXPECT_EQ(recurrence("aaaa"), (Recurrence{0.0, 0.0}));
}

TEST(Recurrence, OfWhatStaysIsOneAppearance) {
  EXPECT_EQ(recurrence("aaaaabbbbcc"), (Recurrence{2.0, 2.0}));
  EXPECT_EQ(recurrence("aaaaabbbaabb"), (Recurrence{2.0, 1.0}));
}

TEST(Recurrence, LeavesOutWhoDoesNotTell) {
  EXPECT_EQ(recurrence("aa?b?aa?"), (Recurrence{1.0, 1.0}));
  EXPECT_EQ(recurrence("bb?bb?b"), (Recurrence{0.0, 0.0}));
  EXPECT_EQ(recurrence("????"), (Recurrence{0.0, 0.0}));
  EXPECT_EQ(recurrence(""), (Recurrence{0.0, 0.0}));
}

TEST(Recurrence, TakesRunsThatNoTimeLinksForAppearancesOfTheirOwn) {
  SequenceHistory history;
  for (int i = 0; i < 5; ++i) history.append(-1.0);
  EXPECT_EQ(recurrence_of(looks_of("aaabb"), history), (Recurrence{2.0, 1.0}));
}

// Whichever pairs of one kind are pooled, until one entry of each kind is left.
TEST(Recurrence, IsTheSameWhereSequencesArePooled) {
  RandomStream random(3, StreamId::kTest);
  for (int trial = 0; trial < 50; ++trial) {
    std::string seen = "a";
    while (seen.size() < 60) {
      seen += random.bernoulli(0.5) ? seen.back() : static_cast<char>('a' + random.below(4));
    }
    const Recurrence before = recurrence(seen);
    SequenceHistory history = history_of_length(seen.size());
    for (std::size_t from = 0; from < seen.size();) {
      const std::size_t into = seen.find(seen[from], from + 1);
      if (into == std::string::npos) {
        ++from;
        continue;
      }
      history.pool(from, into);
      seen.erase(from, 1);
      EXPECT_EQ(recurrence_of(looks_of(seen), history), before);
    }
  }
}

TEST(ReturnProbabilities, AreThoseOfOneAppearanceAsEverywhere) {
  // Everywhere 2 returns and 3 chances more: 3 returns of 3 chances, none of 4, and no chances.
  const std::vector<Recurrence> submaps{{4.0, 1.0}, {5.0, 5.0}, {1.0, 1.0}, {0.0, 0.0}};
  const std::vector<double> found = return_probabilities(submaps);
  const double everywhere = (2.0 + 3.0) / (3.0 + 3.0 + 4.0);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_DOUBLE_EQ(found[0], (3.0 + everywhere) / 4.0);
  EXPECT_DOUBLE_EQ(found[1], everywhere / 5.0);
  EXPECT_DOUBLE_EQ(found[2], everywhere);
  EXPECT_DOUBLE_EQ(found[3], everywhere);
}

TEST(ReturnProbabilities, KeepFewVisitsAndLeaveOutWhatIsAlwaysNew) {
  const double least = RecurrenceConfig{}.min_probability;
  const auto alone = [](const std::string& seen) {
    return return_probabilities(std::vector<Recurrence>{recurrence(seen)})[0];
  };
  EXPECT_GT(alone("ab"), least);
  EXPECT_GT(alone("abc"), least);
  EXPECT_GT(alone("abcd"), least);
  // A corridor of three areas with a new box a day, and what two returns among them are worth.
  for (const double p : return_probabilities(std::vector<Recurrence>{{5, 5}, {3, 3}, {4, 4}})) {
    EXPECT_LT(p, least);
  }
  for (const double p : return_probabilities(std::vector<Recurrence>{{5, 3}, {3, 3}, {4, 4}})) {
    EXPECT_GT(p, least);
  }
}

}  // namespace
}  // namespace strata::patch
