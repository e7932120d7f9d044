// SPDX-License-Identifier: Apache-2.0
/// `kill -9` while it records: everything that is older than a second is readable.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "components/log/bag.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using Clock = std::chrono::steady_clock;
using sensor_msgs::msg::LaserScan;
using std::chrono::milliseconds;

/// The recorder's promise.
constexpr auto kOld = std::chrono::seconds(1);
constexpr auto kPause = milliseconds(5);
/// A machine that stands still for so long between two messages says nothing of the recorder.
constexpr auto kStandstill = milliseconds(100);

/// Publishes numbered scans at 200 Hz and notes when each had been handed over.
class Publisher {
 public:
  explicit Publisher(const std::shared_ptr<bus::Participant>& participant)
      : writer_(participant, "/scan", lossless_from_the_first()) {}

  [[nodiscard]] bool is_matched() {
    return writer_.raw().wait_for_readers(1, std::chrono::seconds(20));
  }
  /// Returns after `length`.
  void publish(milliseconds length) {
    const auto end = Clock::now() + length;
    while (Clock::now() < end) {
      LaserScan scan;
      scan.header().stamp().sec(static_cast<std::int32_t>(noted_.size()));
      scan.ranges().assign(100, static_cast<float>(noted_.size()));
      writer_.publish(scan);
      const auto now = Clock::now();
      if (!noted_.empty()) longest_gap_ = std::max(longest_gap_, now - noted_.back());
      noted_.push_back(now);
      wait_until(now + kPause);
    }
  }
  /// Publishes nothing.
  void rest(milliseconds length) {
    const auto end = Clock::now() + length;
    for (auto now = Clock::now(); now < end; now = Clock::now()) {
      wait_until(now + kPause);
      longest_gap_ = std::max(longest_gap_, Clock::now() - now);
    }
  }
  [[nodiscard]] const std::vector<Clock::time_point>& noted() const { return noted_; }
  [[nodiscard]] bool stood_still() const { return longest_gap_ > kStandstill; }

 private:
  /// The writer knows its reader before the reader knows the writer; what it writes meanwhile comes
  /// too.
  static bus::QosProfile lossless_from_the_first() {
    bus::QosProfile qos = bus::qos_profile("lossless");
    qos.transient_local = true;
    return qos;
  }
  static void wait_until(Clock::time_point moment) { std::this_thread::sleep_until(moment); }

  bus::Writer<LaserScan> writer_;
  std::vector<Clock::time_point> noted_;
  Clock::duration longest_gap_{};
};

std::set<int> readable_numbers(const fs::path& bag) {
  std::set<int> numbers;
  const auto reader = log::BagReader::open(bag);
  log::BagMessage message;
  while (reader->next(message)) {
    numbers.insert(convert::from_cdr<LaserScan>(message.data, "bag").header().stamp().sec());
  }
  return numbers;
}

struct Storage {
  const char* name;
  std::vector<std::string> options;
};

class KilledRecorder : public testing::TestWithParam<Storage> {
 protected:
  /// Records what is published for so long, then nothing for so long, and is killed.
  void expect_what_is_old_is_readable(milliseconds published, milliseconds rested) {
    const auto end = Clock::now() + std::chrono::seconds(60);
    while (Clock::now() < end) {
      if (try_once(published, rested)) return;
    }
    FAIL()
        << "for a minute this machine stood still again and again: run the test with less beside "
           "it";
  }

 private:
  /// False when the machine stood still meanwhile.
  bool try_once(milliseconds published, milliseconds rested) {
    const test::TemporaryDirectory folder;
    const fs::path bag = folder.path() / "bag";
    Publisher publisher(test::make_participant());
    std::vector<std::string> command = {
        STRATA_PROGRAM, "record",     "--quiet",
        "--out",        bag.string(), "--transport",
        "loopback",     "--domain",   std::to_string(test::own_domain()),
        "--topics",     "/scan"};
    command.insert(command.end(), GetParam().options.begin(), GetParam().options.end());
    test::ChildProcess recorder(command);
    EXPECT_TRUE(publisher.is_matched());
    publisher.publish(published);
    publisher.rest(rested);
    const auto killed = Clock::now();
    recorder.kill_hard();
    if (publisher.stood_still()) return false;
    const std::set<int> readable = readable_numbers(bag);
    int old = 0;
    for (std::size_t i = 0; i < publisher.noted().size(); ++i) {
      if (publisher.noted()[i] > killed - kOld) break;
      EXPECT_EQ(readable.count(static_cast<int>(i)), 1U)
          << "message " << i << " was "
          << std::chrono::duration<double>(killed - publisher.noted()[i]).count() << " s old";
      ++old;
    }
    EXPECT_GT(old, 0);
    return true;
  }
};

TEST_P(KilledRecorder, LeavesReadableWhatIsOlderThanASecond) {
  for (const int published_ms : {1250, 1600, 2150, 2700}) {
    expect_what_is_old_is_readable(milliseconds(published_ms), milliseconds(0));
  }
}

/// No further message comes that would bring the ones before it to the file.
TEST_P(KilledRecorder, LeavesReadableWhatWasFollowedByASecondOfSilence) {
  for (const int published_ms : {200, 600}) {
    expect_what_is_old_is_readable(milliseconds(published_ms), kOld);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, KilledRecorder,
    testing::Values(Storage{"Sqlite3", {}}, Storage{"Mcap", {"--storage", "mcap"}},
                    Storage{"McapZstd", {"--storage", "mcap", "--set", "compression=zstd"}},
                    Storage{"McapLz4", {"--storage", "mcap", "--set", "compression=lz4"}}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::tools
