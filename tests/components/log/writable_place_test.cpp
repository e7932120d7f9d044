// SPDX-License-Identifier: Apache-2.0
#include "components/log/writable_place.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

TEST(WritablePlace, IsWhereFoldersCanBeMadeAndNothingIsMade) {
  const test::TemporaryDirectory folder;
  EXPECT_NO_THROW(require_folder_place(folder.path()));
  EXPECT_NO_THROW(require_folder_place(folder.path() / "a" / "b"));
  EXPECT_NO_THROW(require_file_place(folder.path() / "a" / "state"));
  EXPECT_NO_THROW(require_folder_place("a/relative/one"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WritablePlace, IsNotBelowAFileNorAFolderForAFile) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "file";
  std::ofstream(file) << "something";
  EXPECT_NO_THROW(require_file_place(file));
  EXPECT_THROW(require_folder_place(file), OutputError);
  try {
    require_folder_place(file / "a");
    ADD_FAILURE() << "below a file";
  } catch (const OutputError& error) {
    EXPECT_EQ(error.place(), file / "a");
    EXPECT_EQ(error.problem(), file.string() + " is no folder");
  }
  EXPECT_THROW(require_file_place(file / "a"), OutputError);
  EXPECT_THROW(require_file_place(folder.path()), OutputError);
}

}  // namespace
}  // namespace strata::log
