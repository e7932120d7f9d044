// SPDX-License-Identifier: Apache-2.0
/// The search beside a pose that is doubted, where the map ends.
#include <cstddef>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "tests/core/localization/unmapped_room.hpp"

namespace strata::localization {
namespace {

using test::Drive;

/// Begun at a pose, with a search beside it and without.
struct Pair {
  Localizer with = begun(true);
  Localizer without = begun(false);
  std::size_t max_more_bytes = 100;  // of its state, beyond the map

  explicit Pair(const Pose2& start) {
    for (Localizer* localizer : {&with, &without}) {
      localizer->set_free_space(unmapped_room::corridor_map());
      localizer->initialize({start, Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
    }
  }
  /// The same map anew, as from somebody who learns.
  void take_a_map() {
    for (Localizer* localizer : {&with, &without}) {
      localizer->set_model(unmapped_room::models().front());
      localizer->set_free_space(unmapped_room::corridor_map());
    }
  }
  /// Both see it. The one with a search must be as if it had none.
  LocalizationResult see(const Observation& seen, int n) {
    const LocalizationResult result = with.update(seen);
    EXPECT_EQ(result.pose.mean, without.update(seen).pose.mean) << n;
    if (result.is_beyond_map) {
      EXPECT_LT(with.saved_state()->size(), without.saved_state()->size() + max_more_bytes) << n;
    }
    return result;
  }

 private:
  static Localizer begun(bool is_used) {
    LocalizerConfig config;
    config.global_search.watch.is_used = is_used;
    return {config, unmapped_room::models().front(), 5, 1};
  }
};

TEST(LocalizerWatch, LooksForNothingWhereTheMapEnds) {
  Drive drive({8.5, 0.8, 1.57}, 4);
  Pair pair(drive.truth());
  std::size_t outside = 0;
  double score = 1.0;
  for (int n = 0; n < 300; ++n) {
    drive.step({n < 40 ? 0.1 : 0.05, 0.0, n < 40 ? 0.0 : 0.1});  // into the room, and about in it
    if (n == 150) pair.take_a_map();
    const LocalizationResult result = pair.see(drive.look(unmapped_room::building()), n);
    if (!result.is_beyond_map) continue;
    ++outside;
    score = result.score;
  }
  EXPECT_GT(outside, 200U);
  EXPECT_LT(score, 0.3) << "nothing was doubted";
}

TEST(LocalizerWatch, LooksForNothingWhereARobotIsSaidToBeginBeyondTheMap) {
  Drive drive({8.5, 4.2, 1.57}, 4);
  Pair pair(drive.truth());
  std::size_t outside = 0;
  for (int n = 0; n < 150; ++n) {
    drive.step({0.05, 0.0, 0.1});
    const LocalizationResult result = pair.see(drive.look(unmapped_room::building()), n);
    EXPECT_FALSE(result.is_ambiguous) << n;
    outside += result.is_beyond_map ? 1 : 0;
  }
  EXPECT_GT(outside, 100U);
}

TEST(LocalizerWatch, BelievesAPoseStillWhenAMapComesAndScansSpeakAgainstItBeforeTheMapEnds) {
  Drive drive({8.5, 1.3, 1.57}, 4);
  Drive elsewhere({3.0, 1.3, 0.0}, 4);
  Pair pair(drive.truth());
  pair.max_more_bytes = 10'000;  // the scans that spoke against it, but no second filter of 3 MB
  std::size_t outside = 0;
  double last = 1.0;  // score in the map
  for (int n = 0; n < 100; ++n) {
    drive.step({n < 40 ? 0.1 : 0.05, 0.0, n < 40 ? 0.0 : 0.1});
    elsewhere.step({});
    if (n == 4) pair.take_a_map();
    Observation seen = drive.look(unmapped_room::building());
    if (n >= 4 && n < 8) {
      const Observation wrong = elsewhere.look(unmapped_room::building());
      seen.scan.ranges_m = wrong.scan.ranges_m;
    }
    const LocalizationResult result = pair.see(seen, n);
    outside += result.is_beyond_map ? 1 : 0;
    if (outside == 0) last = result.score;
  }
  EXPECT_GT(outside, 60U);
  EXPECT_LT(last, 0.3) << "nothing was doubted";
}

TEST(LocalizerWatch, FindsARobotThatIsWronglyBelievedToHaveLeftTheMap) {
  // Said to be before the gap, it is believed to drive into the room; it is in the corridor.
  Localizer localizer(LocalizerConfig{}, unmapped_room::models().front(), 5, 1);
  localizer.set_free_space(unmapped_room::corridor_map());
  localizer.initialize({{8.5, 1.6, 1.57}, Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
  Drive drive({2.0, 1.0, 0.0}, 4);
  std::size_t outside = 0;
  std::size_t found = 0;
  for (int n = 0; n < 120; ++n) {
    drive.step({0.1, 0.0, 0.0});
    const LocalizationResult result = localizer.update(drive.look(unmapped_room::building()));
    outside += result.is_beyond_map ? 1 : 0;
    found += translation_distance(result.pose.mean, drive.truth()) < 0.3 ? 1 : 0;
  }
  EXPECT_GT(outside, 3U) << "it never was believed to have left";
  EXPECT_GT(found, 60U);
}

}  // namespace
}  // namespace strata::localization
