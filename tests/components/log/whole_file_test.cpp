// SPDX-License-Identifier: Apache-2.0
#include "components/log/whole_file.hpp"

#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

TEST(ReadWholeFile, GivesBackEveryByteThatWasWritten) {
  const test::TemporaryDirectory folder;
  for (const std::string& bytes :
       {std::string("a\0\r\n\x1a\xff", 6), std::string(100'000, 'x'), std::string()}) {
    write_whole_file(folder.path() / "bytes", bytes);
    EXPECT_EQ(read_whole_file(folder.path() / "bytes"), bytes);
  }
}

TEST(ReadWholeFile, RefusesWhatIsMissingAndFolders) {
  const test::TemporaryDirectory folder;
  EXPECT_THROW((void)read_whole_file(folder.path() / "missing"), InputError);
  EXPECT_THROW((void)read_whole_file(folder.path()), InputError);
}

}  // namespace
}  // namespace strata::log
