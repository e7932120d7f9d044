// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/learn_pictures.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/map_file.hpp"
#include "core/base/error.hpp"
#include "core/beam_filter/beam_filter.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"

namespace strata::pipeline {
namespace {

using ::testing::HasSubstr;

slam::SlamResult learn_room() {
  slam::Slam slam(slam::SlamConfig{});
  for (const Observation& observation : test_room::simulate_runs(101, 1).observations) {
    slam.add(observation);
  }
  return slam.finish();
}

TEST(LearnPictures, ShowTheMapAfterEachRoundOfEm) {
  const test::TemporaryDirectory folder;
  const slam::SlamResult result = learn_room();
  const beam_filter::BeamFilterConfig config;
  write_learn_pictures(folder.path() / "pictures", result, config);
  beam_filter::BeamFilterConfig by_rounds = config;
  by_rounds.mode = beam_filter::Mode::kIterate;
  by_rounds.endpoint_tolerance = false;
  by_rounds.min_gain = 0.0;
  for (int round = 0; round <= kShownRounds; ++round) {
    const std::string name = "round_" + std::to_string(round);
    const ReflectionGrid shown = log::read_map(folder.path() / "pictures" / (name + ".yaml"));
    by_rounds.max_iterations = std::max(round, 1);
    const ReflectionGrid expected =
        round == 0 ? result.occupancy : filter_counts(result.raw, by_rounds).filtered;
    std::size_t occupied = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const float m = expected.values()[i];
      ASSERT_EQ(is_occupied(shown.get(expected.cell(i))), is_occupied(m)) << name;
      occupied += is_occupied(m) ? 1 : 0;
    }
    EXPECT_GT(occupied, 100U);
    EXPECT_THAT(test::bytes_of(folder.path() / "pictures" / (name + ".png")), HasSubstr("PNG"));
  }
  const std::string page = test::bytes_of(folder.path() / "pictures" / "report.html");
  EXPECT_THAT(page, HasSubstr("all beams, dynamic ones in red"));
  const std::string trace = test::bytes_of(folder.path() / "pictures" / "log_likelihood.csv");
  const auto lines = static_cast<std::size_t>(std::count(trace.begin(), trace.end(), '\n'));
  EXPECT_EQ(lines, 1 + result.log_likelihood.size());
}

TEST(LearnPictures, OfNothingAreAPageThatSaysSo) {
  const test::TemporaryDirectory folder;
  write_learn_pictures(folder.path(), slam::Slam(slam::SlamConfig{}).finish(), {});
  EXPECT_THAT(test::bytes_of(folder.path() / "report.html"), HasSubstr("No scan was mapped"));
}

TEST(LearnPictures, RefuseAFolderThatCannotBe) {
  const test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "file") << "in the way";
  EXPECT_THROW(write_learn_pictures(folder.path() / "file" / "pictures", learn_room(), {}),
               OutputError);
}

}  // namespace
}  // namespace strata::pipeline
