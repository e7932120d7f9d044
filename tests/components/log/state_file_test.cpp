// SPDX-License-Identifier: Apache-2.0
#include "components/log/state_file.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

class StateFile : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "state"; }
  test::TemporaryDirectory folder_;
};

TEST_F(StateFile, GivesBackWhatWasWrittenAndTheNewestWhenThereAreMany) {
  for (const std::size_t size : {0U, 1U, 100'000U}) {
    write_state_file(file(), Bytes(size, 7));
    EXPECT_EQ(read_state_file(file()), Bytes(size, 7));
  }
  StateFileWriter writer(file());
  for (std::uint8_t i = 0; i < 100; ++i) writer.write(Bytes(10'000, i));
  writer.flush();
  EXPECT_EQ(read_state_file(file()), Bytes(10'000, 99));
  EXPECT_FALSE(writer.take_error());
  { StateFileWriter(file()).write({1, 2, 3}); }
  EXPECT_EQ(read_state_file(file()), (Bytes{1, 2, 3})) << "its end writes what waits";
}

TEST_F(StateFile, IsDueOnceAPeriodAlsoWhenTheClockIsSetBack) {
  StateFileWriter writer(file(), 10.0);
  const auto is_due = [&](double time_s) { return writer.is_due(Stamp::from_seconds(time_s)); };
  EXPECT_TRUE(is_due(100.0));
  EXPECT_FALSE(is_due(109.0));
  EXPECT_TRUE(is_due(110.0));
  EXPECT_FALSE(is_due(115.0));
  EXPECT_TRUE(is_due(50.0));
  EXPECT_FALSE(is_due(51.0));
}

TEST_F(StateFile, TellsOnceWhyAStateCouldNotBeWritten) {
  std::ofstream(file()) << "no folder";
  StateFileWriter writer(file() / "below");
  writer.write({1});
  writer.flush();
  EXPECT_THAT(writer.take_error().value_or(""), testing::HasSubstr((file() / "below").string()));
  EXPECT_FALSE(writer.take_error());
}

TEST_F(StateFile, ThatIsMissingOrDamagedIsRefused) {
  EXPECT_THROW((void)read_state_file(file()), InputError);
  std::ofstream(file()) << "something else";
  EXPECT_THROW((void)read_state_file(file()), InputError);
  write_state_file(file(), Bytes(1'000, 3));
  std::filesystem::resize_file(file(), std::filesystem::file_size(file()) - 1);
  EXPECT_THROW((void)read_state_file(file()), InputError);
}

}  // namespace
}  // namespace strata::log
