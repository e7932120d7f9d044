// SPDX-License-Identifier: Apache-2.0
/// ROS 1 bags that are cut, spoilt or of another kind: what can be read is, and the rest is said.
#include <filesystem>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using test_log::Ros1End;
using test_log::write_text;
using ::testing::Contains;
using ::testing::HasSubstr;

class DamagedRos1Bag : public ::testing::Test {
 protected:
  void SetUp() override {
    const fs::path folder = folder_.path() / "ros2";
    write_bag(folder, test_log::make_log(400, 180, 7), BagStorage::kSqlite3, BagCompression::kNone);
    for (const Observation& whole : read_observations(folder)) {
      stamps_.insert(whole.scan.stamp.ns);
    }
  }
  std::string bag(const std::string& compression, Ros1End end = Ros1End::kWhole) {
    return test_log::ros1_bag_of(folder_.path() / "ros2", {.compression = compression, .end = end});
  }
  fs::path write(const std::string& bytes) {
    write_text(folder_.path() / "drive.bag", bytes);
    return folder_.path() / "drive.bag";
  }
  /// Reads what is left; every scan of it is one of the log.
  std::size_t read(const std::string& bytes) {
    report_ = {};
    const auto scans = read_observations(write(bytes), {}, &report_);
    for (const Observation& scan : scans) {
      EXPECT_TRUE(stamps_.contains(scan.scan.stamp.ns));
      EXPECT_EQ(scan.scan.size(), 180U);
    }
    return scans.size();
  }
  std::string error_of(const std::string& bytes) {
    try {
      (void)read_observations(write(bytes));
    } catch (const InputError& error) {
      EXPECT_THAT(error.place(), HasSubstr("drive.bag"));
      EXPECT_FALSE(error.remedy().empty());
      return error.what();
    }
    return "";
  }
  strata::test::TemporaryDirectory folder_;
  std::set<std::int64_t> stamps_;
  ReadReport report_;
};

TEST_F(DamagedRos1Bag, IsReadUpToWhereItWasCut) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::string whole = bag(compression);
    for (const double share : {0.3, 0.5, 0.8, 0.99}) {
      const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
      const std::size_t scans = read(whole.substr(0, size));
      EXPECT_GE(static_cast<double>(scans), 400.0 * (share - 0.1)) << compression << " " << share;
      EXPECT_GE(report_.bad_lines, 1U);
      EXPECT_THAT(report_.warnings, Contains(HasSubstr("drive.bag: byte ")));
    }
  }
}

TEST_F(DamagedRos1Bag, OfWhichTheLastChunkIsCutGivesItsWholeMessages) {
  const std::string whole = bag("none", Ros1End::kUnfinishedChunk);
  const std::size_t all = read(whole);
  EXPECT_EQ(all, stamps_.size());
  const std::size_t less = read(whole.substr(0, whole.size() - 2000));
  EXPECT_LT(less, all);
  EXPECT_GE(less, all - 3);
}

TEST_F(DamagedRos1Bag, GoesOnAtTheNextChunkThatTheIndexKnows) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    std::string bytes = bag(compression);
    const std::size_t chunk = bytes.find("compression=", bytes.size() / 2);
    ASSERT_NE(chunk, std::string::npos);
    bytes[chunk - 13] = '\x7F';  // of the length of the chunk's header
    const std::size_t scans = read(bytes);
    EXPECT_LT(scans, stamps_.size());
    EXPECT_GE(scans, stamps_.size() - 60) << compression;
    EXPECT_THAT(report_.warnings, Contains(HasSubstr("next chunk")));
  }
}

TEST_F(DamagedRos1Bag, LosesAChunkWhosePackedBytesAreSpoilt) {
  for (const char* compression : {"bz2", "lz4"}) {
    std::string bytes = bag(compression);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
    EXPECT_LT(read(bytes), stamps_.size());
    EXPECT_EQ(report_.bad_lines, 1U);
    EXPECT_THAT(report_.first_bad, HasSubstr("a chunk is left out"));
  }
}

TEST_F(DamagedRos1Bag, IsReadWithoutItsHeader) {
  std::string bytes = bag("lz4");
  bytes[20] = 'x';
  EXPECT_EQ(read(bytes), stamps_.size());
  EXPECT_THAT(report_.first_bad, HasSubstr("the bag's header is damaged"));
}

TEST_F(DamagedRos1Bag, WithNothingInItIsRefusedWithPlaceAndRemedy) {
  const std::string whole = bag("none");
  EXPECT_THAT(error_of(whole.substr(0, 13)), HasSubstr("byte 13"));
  EXPECT_THAT(error_of(whole.substr(0, 5000)), HasSubstr("byte"));
  const std::string once = error_of(whole.substr(0, 4200));
  EXPECT_EQ(once.find("drive.bag"), once.rfind("drive.bag")) << once;
  EXPECT_THAT(error_of("#ROSBAG V2.0\n" + std::string(9000, 'x')), HasSubstr("byte 13"));
}

TEST_F(DamagedRos1Bag, OfAnotherFormatIsNamed) {
  EXPECT_THAT(error_of("#ROSRECORD V1.2\nrest"), HasSubstr("ROSRECORD V1.2"));
  EXPECT_THAT(error_of("#ROSBAG V2.1\nrest"), HasSubstr("only 2.0"));
  const auto header =
      test_log::Ros1Bytes().field("op", "\x03").field("encryptor", "rosbag/AesCbcEncryptor");
  EXPECT_THAT(
      error_of("#ROSBAG V2.0\n" + test_log::Ros1Bytes().text(header.bytes()).text("    ").bytes()),
      HasSubstr("is encrypted"));
}

TEST_F(DamagedRos1Bag, WithAnUnknownCompressionSaysWhich) {
  std::string bytes = bag("none");
  for (std::size_t at = bytes.find("=none"); at != std::string::npos;
       at = bytes.find("=none", at)) {
    bytes.replace(at, 5, "=zstd");
  }
  EXPECT_THAT(error_of(bytes), HasSubstr("unknown compression zstd"));
}

}  // namespace
}  // namespace strata::log
