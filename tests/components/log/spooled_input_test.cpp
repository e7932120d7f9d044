// SPDX-License-Identifier: Apache-2.0
#include "components/log/spooled_input.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "components/log/carmen.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

class SpooledInput : public ::testing::Test {
 protected:
  /// A pipe into which the file is written once.
  fs::path pipe_of(const fs::path& file) {
    const fs::path pipe = folder_.path() / "pipe";
    EXPECT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    writer_ = std::thread([pipe, content = test::bytes_of(file)] {
      std::ofstream(pipe, std::ios::binary) << content;
    });
    return pipe;
  }
  ~SpooledInput() override {
    if (writer_.joinable()) writer_.join();
  }
  const strata::test::TemporaryDirectory folder_;

 private:
  std::thread writer_;
};

TEST_F(SpooledInput, OfAPipeIsReadWholeAndAsOftenAsItIsAskedFor) {
  const fs::path file = folder_.path() / "log.clf";
  write_carmen(file, test_log::make_log(400, 61, 1));
  const auto scans = read_observations(file);
  const fs::path pipe = pipe_of(file);
  for (int time = 0; time < 2; ++time) {
    const auto piped = read_observations(pipe);
    ASSERT_EQ(piped.size(), scans.size()) << time;
    EXPECT_EQ(piped.back().scan.stamp, scans.back().scan.stamp);
    EXPECT_EQ(piped.back().scan.ranges_m, scans.back().scan.ranges_m);
  }
}

TEST_F(SpooledInput, OfAPipeKeepsTheNameThatWasGiven) {
  const fs::path file = folder_.path() / "none.clf";
  test_log::write_text(file, "FLASER x\n");
  const fs::path pipe = pipe_of(file);
  try {
    (void)read_observations(pipe);
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), pipe.string() +
                                 ":1: field 2, 'x', is no number of readings from 0 to "
                                 "100000");
  }
}

TEST_F(SpooledInput, IsNoDevice) {
  EXPECT_THROW((void)readable_path("/dev/zero"), InputError);
  EXPECT_EQ(readable_path("/no/such/file"), "/no/such/file");
  EXPECT_EQ(readable_path(folder_.path()), folder_.path());
}

TEST_F(SpooledInput, SaysWhyThereIsNoWayToIt) {
  const auto told = [](const fs::path& path) -> std::string {
    try {
      require_reachable(path);
    } catch (const InputError& error) {
      return error.problem();
    }
    return "";
  };
  EXPECT_EQ(told(folder_.path()), "");
  EXPECT_EQ(told(folder_.path() / "none"), "does not exist");
  EXPECT_EQ(told(folder_.path() / std::string(300, 'n')), "cannot be reached: File name too long");
  EXPECT_EQ(told(""), "is an empty name");
}

}  // namespace
}  // namespace strata::log
