// SPDX-License-Identifier: Apache-2.0
#include "components/log/state_store.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

class StateStoreTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file() const { return folder_.path() / "state"; }
  test::TemporaryDirectory folder_;
};

TEST_F(StateStoreTest, GivesBackWhatWasWrittenAndTheNewestWhenThereAreMany) {
  for (const std::size_t size : {0U, 1U, 100'000U}) {
    write_state_file(file(), Bytes(size, 7));
    EXPECT_EQ(read_state_file(file()), Bytes(size, 7));
  }
  StateStore store({file()});
  for (std::uint8_t i = 0; i < 100; ++i) store.write(Bytes(10'000, i));
  store.flush();
  EXPECT_EQ(store.load(), Bytes(10'000, 99));
  { StateStore({file()}).write({1, 2, 3}); }
  EXPECT_EQ(store.load(), (Bytes{1, 2, 3})) << "its end writes what waits";
}

TEST_F(StateStoreTest, MakesItsFolder) {
  const std::string below = file() + "-folder/of/it.state";
  write_state_file(below, Bytes(10, 7));
  EXPECT_EQ(read_state_file(below), Bytes(10, 7));
}

TEST_F(StateStoreTest, IsDueOnceAPeriodAlsoWhenTheClockIsSetBack) {
  StateStore store({file(), 10.0});
  const auto is_due = [&](double time_s) { return store.is_due(Stamp::from_seconds(time_s)); };
  EXPECT_TRUE(is_due(100.0));
  EXPECT_FALSE(is_due(109.0));
  EXPECT_TRUE(is_due(110.0));
  EXPECT_FALSE(is_due(115.0));
  EXPECT_TRUE(is_due(50.0));
  EXPECT_FALSE(is_due(51.0));
}

TEST_F(StateStoreTest, TellsOnceWhyAStateCouldNotBeWritten) {
  std::ofstream(file()) << "no folder";
  StateStore store({file() + "/below"});
  store.write({1});
  try {
    store.flush();
    FAIL() << "no error";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(file() + "/below"));
  }
  EXPECT_NO_THROW(store.check());
}

TEST_F(StateStoreTest, LoadsNothingWithoutAFileAndRefusesADamagedOne) {
  EXPECT_FALSE(StateStore({file()}).load());
  EXPECT_THROW((void)read_state_file(file()), InputError);
  std::ofstream(file()) << "something else";
  EXPECT_THROW((void)read_state_file(file()), InputError);
  write_state_file(file(), Bytes(1'000, 3));
  std::filesystem::resize_file(file(), std::filesystem::file_size(file()) - 1);
  EXPECT_THROW((void)read_state_file(file()), InputError);
  EXPECT_THROW((void)StateStore({file()}).load(), InputError);
}

}  // namespace
}  // namespace strata::log
