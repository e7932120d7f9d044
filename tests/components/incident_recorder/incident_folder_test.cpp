// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/incident_folder.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::incident_recorder {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class IncidentFolder : public testing::Test {
 protected:
  [[nodiscard]] fs::path incidents() const { return folder_.path() / "incidents"; }
  void write(const fs::path& path, const std::string& text) {
    fs::create_directories((folder_.path() / path).parent_path());
    std::ofstream(folder_.path() / path) << text;
  }
  [[nodiscard]] std::string at(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  IncidentRecord make(std::int64_t at_s, std::size_t bytes, std::vector<KeptFile> files = {}) {
    IncidentRecord record;
    record.at_ns = at_s * 1'000'000'000;
    record.folder = free_name(incidents(), record.at_ns, "lost");
    record.reasons = {{"lost", "localizer: health", "lost"}};
    record.files = std::move(files);
    record.is_complete = true;
    fs::create_directories(record.folder);
    std::ofstream(record.folder / "bag_0.mcap") << std::string(bytes, 'x');
    write_record(record);
    return record;
  }

 private:
  test::TemporaryDirectory folder_;
};

TEST_F(IncidentFolder, ReadsRecordsAsTheyWereWrittenOldestFirst) {
  IncidentRecord later = make(2000, 10);
  later.reasons.push_back({"error", "lidar: driver", "silent"});
  later.before_s = 60.0;
  later.messages = 7;
  later.lost = 2;
  later.files = {{"maps", "abc"}};
  later.is_complete = false;
  write_record(later);
  const IncidentRecord earlier = make(1000, 10);
  const auto records = read_records(incidents());
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[0].folder, earlier.folder);
  EXPECT_EQ(json_text(records[1]), json_text(later));
  EXPECT_GT(records[1].bytes, 10U);
}

TEST_F(IncidentFolder, PassesOverWhatIsNoIncident) {
  make(1000, 10);
  fs::create_directories(incidents() / "mine");
  fs::create_directories(incidents() / "cut");
  std::ofstream(incidents() / "cut" / kIncidentFile) << R"({"kind": "incident", "reasons": [)";
  fs::create_directories(incidents() / "odd");
  std::ofstream(incidents() / "odd" / kIncidentFile) << R"({"kind": "incident", "reasons": 3})";
  EXPECT_THAT(read_records(incidents()), SizeIs(1));
  EXPECT_THAT(read_records(incidents() / "nowhere"), IsEmpty());
}

TEST_F(IncidentFolder, NamesTwoOfOneSecondApart) {
  const IncidentRecord first = make(0, 1);
  const IncidentRecord second = make(0, 1);
  EXPECT_EQ(first.folder.filename(), "1970-01-01T00-00-00Z_lost");
  EXPECT_EQ(second.folder.filename(), "1970-01-01T00-00-00Z_lost_2");
}

TEST_F(IncidentFolder, KeepsEqualContentsOnceAndTellsFoldersApartByWhatIsInThem) {
  write("maps/strata.db", "one");
  write("same/maps/strata.db", "one");
  write("other/maps/strata.db", "two");
  write("run.yaml", "version: 1");
  fs::create_directories(incidents());
  std::vector<std::string> problems;
  const auto kept = keep_files(
      incidents(), {at("maps/"), at("same/maps"), at("other/maps"), at("run.yaml")}, problems);
  EXPECT_THAT(problems, IsEmpty());
  ASSERT_THAT(kept, SizeIs(4));
  EXPECT_EQ(kept[0].sha256, kept[1].sha256);
  EXPECT_NE(kept[0].sha256, kept[2].sha256);
  const fs::path files = incidents() / "files";
  EXPECT_EQ(std::distance(fs::directory_iterator(files), fs::directory_iterator()), 3);
  EXPECT_TRUE(fs::exists(files / kept[2].sha256 / "maps" / "strata.db"));
  EXPECT_TRUE(fs::exists(files / kept[3].sha256 / "run.yaml"));
}

TEST_F(IncidentFolder, NamesWhatItCouldNotCopy) {
  std::vector<std::string> problems;
  EXPECT_THAT(keep_files(incidents(), {at("nowhere")}, problems), IsEmpty());
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_THAT(problems[0], testing::HasSubstr("nowhere"));
}

TEST_F(IncidentFolder, MakesRoomByTheOldestAndTheirFilesButNeverByTheNewest) {
  write("maps/strata.db", std::string(4000, 'a'));
  fs::create_directories(incidents());
  std::vector<std::string> problems;
  const auto files = keep_files(incidents(), {at("maps")}, problems);
  const IncidentRecord first = make(1000, 3000, files);
  const IncidentRecord second = make(2000, 3000);
  const IncidentRecord third = make(3000, 3000);
  EXPECT_EQ(make_room(incidents(), 100'000), 0U);
  EXPECT_TRUE(fs::exists(incidents() / "files" / files[0].sha256));
  EXPECT_EQ(make_room(incidents(), 10'000), 1U) << "14 kB with the maps";
  EXPECT_FALSE(fs::exists(first.folder));
  EXPECT_FALSE(fs::exists(incidents() / "files" / files[0].sha256));
  EXPECT_EQ(make_room(incidents(), 100), 1U);
  EXPECT_FALSE(fs::exists(second.folder));
  EXPECT_TRUE(fs::exists(third.folder));
}

TEST_F(IncidentFolder, MakesRoomThoughACopyIsMissing) {
  const IncidentRecord first = make(1000, 3000, {{"maps", "removed-by-hand"}});
  const IncidentRecord second = make(2000, 3000, {{"maps", "removed-by-hand"}});
  EXPECT_EQ(make_room(incidents(), 100'000), 0U);
  EXPECT_EQ(make_room(incidents(), 5'000), 1U);
  EXPECT_FALSE(fs::exists(first.folder));
  EXPECT_TRUE(fs::exists(second.folder));
}

}  // namespace
}  // namespace strata::incident_recorder
