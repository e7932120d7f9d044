// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/incident_recorder/incident.hpp"
#include "core/base/error.hpp"
#include "tests/components/incident_recorder/numbered_scans.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace strata::incident_recorder {
namespace {

using ::testing::SizeIs;

TEST(Incident, OfAProcessThatIsKilledIsListedAsCutOffAndCanBeRead) {
  const test::TemporaryDirectory folder;
  const auto topic =
      std::make_shared<const KeptTopic>(KeptTopic{"/scan", "sensor_msgs/msg/LaserScan", "", false});
  const auto message = [&](int number) {
    return std::make_shared<const KeptMessage>(KeptMessage{
        topic, {}, Stamp{number * 1'000'000'000LL}, {}, convert::to_cdr(numbered(number))});
  };
  IncidentRecord record;
  record.folder = folder.path() / "all" / "one";
  record.reasons = {{"lost", "localizer: health", "lost"}};
  std::filesystem::create_directories(folder.path() / "all");
  std::ofstream(folder.path() / "run.yaml") << "version: 1";
  const IncidentPlan plan{
      folder.path() / "all", {(folder.path() / "run.yaml").string()}, 1'000'000'000, 1'000'000};
  Incident incident(plan, record, {message(1), message(2)});
  // As the disk is at the moment of a kill.
  const auto copy = folder.path() / "killed";
  std::map<std::string, std::vector<int>> scans;
  EXPECT_TRUE(test::comes_true([&] {
    std::filesystem::remove_all(copy);
    std::filesystem::copy(folder.path() / "all", copy, std::filesystem::copy_options::recursive);
    try {
      scans = scans_in(copy / "one");
    } catch (const Error&) {  // nothing is in it yet
    }
    return scans["/scan"].size() == 2;
  }));
  EXPECT_EQ(scans["/scan"], (std::vector<int>{1, 2}));
  const auto records = read_records(copy);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_FALSE(records[0].is_complete);
  ASSERT_THAT(records[0].files, SizeIs(1));
  EXPECT_EQ(make_room(copy, 1'000'000'000), 0U);
  EXPECT_TRUE(std::filesystem::exists(copy / "files" / records[0].files[0].sha256 / "run.yaml"));
}

}  // namespace
}  // namespace strata::incident_recorder
