// SPDX-License-Identifier: Apache-2.0
/// What is taken for no return in real logs, as they are and with the codes of other scanners in
/// place of their own.
#include "core/scan/no_return.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/scan_messages.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "core/random/stream.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr float kInf = std::numeric_limits<float>::infinity();

struct Known {
  const char* log;
  float from_m;  ///< 80: what SICK's codes lie above, and no pile below it
};
class NoReturnOfARealLog : public ::testing::TestWithParam<Known> {};

TEST_P(NoReturnOfARealLog, IsWhatItsScannerSent) {
  STRATA_REQUIRE_DATA(path, GetParam().log);
  ReadReport report;
  (void)read_observations(path, {}, &report);
  ASSERT_THAT(report.no_returns, SizeIs(1));
  EXPECT_EQ(report.no_returns[0].from_m, GetParam().from_m) << report.no_returns[0].why;
  EXPECT_THAT(report.no_returns[0].why, HasSubstr(GetParam().from_m == 80.0F ? "SICK" : "pile up"));
}

INSTANTIATE_TEST_SUITE_P(
    All, NoReturnOfARealLog,
    ::testing::Values(Known{"csail/csail.clf.gz", 80.0F}, Known{"fhw/fhw-corrected.log.gz", 51.05F},
                      Known{"fr079/fr079.clf.gz", 80.0F}, Known{"intel/intel.clf.gz", 80.0F},
                      Known{"radish/acapulco/log.clf.gz", 50.0F},
                      Known{"radish/belgioioso/log.clf.gz", 80.0F},
                      Known{"radish/freiburg-101/log.clf.gz", 80.0F},
                      Known{"radish/freiburg-campus/log.clf.gz", 80.0F},
                      Known{"radish/seattle/log.clf.gz", 80.0F},
                      Known{"wean_hall/run1.clf.gz", 80.0F}, Known{"wean_hall/run2.clf.gz", 80.0F},
                      Known{"wean_hall/run3.clf.gz", 80.0F}));

/// A scanner that sees as far as `reach_m` and sends `code` for what it does not see.
struct Scanner {
  const char* name;
  float reach_m;
  std::function<float(RandomStream&)> code;
  std::size_t codes;  ///< that there are to be found
};
const Scanner kScanners[] = {
    {"50", 50.0F, [](RandomStream&) { return 50.0F; }, 1},
    {"scattered", 51.0F,
     [](RandomStream& random) {
       const double code_m = 51.1 + std::clamp(random.normal(0.0, 0.02), -0.05, 0.06);
       return static_cast<float>(std::round(code_m * 100.0) / 100.0);
     },
     1},
    {"two codes", 60.0F,
     [](RandomStream& random) { return random.uniform() < 0.1 ? 60.0F : 61.15F; }, 2},
    {"reach of 4 m", 4.0F, [](RandomStream&) { return 4.0F; }, 1},
    {"reach of 8 m, code of 8.19", 8.0F, [](RandomStream&) { return 8.19F; }, 1},
    {"infinity", 80.0F, [](RandomStream&) { return kInf; }, 0},
    {"infinity from 10 m", 10.0F, [](RandomStream&) { return kInf; }, 0},
};

class NoReturnOfOtherScanners : public ::testing::TestWithParam<const char*> {};

TEST_P(NoReturnOfOtherScanners, IsFoundInTheirReadings) {
  STRATA_REQUIRE_DATA(path, GetParam());
  const std::vector<Observation> log = read_observations(path);
  for (const Scanner& scanner : kScanners) {
    SCOPED_TRACE(scanner.name);
    RandomStream random(1, StreamId::kTest);
    std::vector<Observation> seen = log;
    std::vector<PlacedScan> placed;
    std::size_t sent = 0;
    for (Observation& observation : seen) {
      Scan& scan = observation.scan;
      scan.range_max_m = 80.0F;
      for (float& range : scan.ranges_m) {
        const bool returns = range < scanner.reach_m;  // false for +Inf
        if (!returns && !std::isnan(range)) range = scanner.code(random);
        sent += returns ? 0 : 1;
      }
      placed.push_back({&scan, observation.odom_from_robot});
    }
    const auto codes = find_no_return_codes(placed);
    ASSERT_THAT(codes, SizeIs(scanner.codes));
    if (codes.empty()) continue;
    std::size_t missed = 0;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (std::size_t beam = 0; beam < seen[i].scan.size(); ++beam) {
        const bool returned = log[i].scan.ranges_m[beam] < scanner.reach_m;
        const bool is_hit = seen[i].scan.ranges_m[beam] < codes.back().from_m;
        missed += !returned && is_hit ? 1 : 0;
        taken += returned && !is_hit ? 1 : 0;
      }
    }
    EXPECT_EQ(missed, 0U);
    EXPECT_LE(taken, sent / 50 + 2) << "readings beyond the code, and at the reach itself";
  }
}

INSTANTIATE_TEST_SUITE_P(All, NoReturnOfOtherScanners,
                         ::testing::Values("csail/csail.clf.gz", "fr079/fr079.clf.gz",
                                           "intel/intel.clf.gz", "radish/belgioioso/log.clf.gz",
                                           "radish/freiburg-101/log.clf.gz",
                                           "radish/seattle/log.clf.gz", "wean_hall/run1.clf.gz",
                                           "wean_hall/run2.clf.gz", "wean_hall/run3.clf.gz"));

class NoReturnOfALog : public ::testing::Test {
 protected:
  /// A scanner that sends 20.5 for what it does not see, and says that it sees up to range_max_m.
  std::filesystem::path bag(float range_max_m) {
    LogContent log = test_log::make_log(40, 90, 3);
    for (Observation& observation : log.observations) {
      observation.scan.range_max_m = range_max_m;
      for (float& range : observation.scan.ranges_m) range = std::isinf(range) ? 20.5F : range;
    }
    std::filesystem::remove_all(folder_.path() / "bag");
    write_bag(folder_.path() / "bag", log, BagStorage::kMcap);
    return folder_.path() / "bag";
  }
  [[nodiscard]] static std::size_t seen_nothing(const std::vector<Observation>& scans) {
    std::size_t count = 0;
    for (const Observation& observation : scans) {
      count += count_beams(observation.scan).no_returns;
    }
    return count;
  }
  strata::test::TemporaryDirectory folder_;
  ReadReport report_;
};

TEST_F(NoReturnOfALog, IsFoundInBagsWhateverTheirRangeMax) {
  const std::size_t expected = seen_nothing(test_log::make_log(40, 90, 3).observations);
  for (const float range_max_m : {0.0F, 20.5F, 30.0F, kInf}) {
    const auto scans = read_observations(bag(range_max_m), {}, &report_);
    EXPECT_EQ(seen_nothing(scans), expected) << range_max_m;
    ASSERT_THAT(report_.no_returns, SizeIs(1));
    EXPECT_EQ(report_.no_returns[0].from_m, 20.5F);
    EXPECT_THAT(
        report_.no_returns[0].why,
        HasSubstr(range_max_m == 20.5F ? "range_max of its messages" : "of exactly 20.5 m"));
  }
}

TEST_F(NoReturnOfALog, IsWhatTheUserSays) {
  ReadOptions options;
  options.max_range_m = 5.0;
  const auto scans = read_observations(bag(30.0F), options, &report_);
  EXPECT_EQ(scans[0].scan.range_max_m, 5.0F);
  for (const float range : scans[0].scan.ranges_m) EXPECT_TRUE(range < 5.0F || std::isinf(range));
  ASSERT_THAT(report_.no_returns, SizeIs(1));
  EXPECT_EQ(report_.no_returns[0].from_m, 5.0F);
  EXPECT_THAT(report_.no_returns[0].why, HasSubstr("as told"));
  EXPECT_THAT(report_.warnings, IsEmpty());
  // Also that a code is none.
  options.max_range_m = 30.0;
  EXPECT_EQ(seen_nothing(read_observations(bag(30.0F), options)), 0U);
}

}  // namespace
}  // namespace strata::log
