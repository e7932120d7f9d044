// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/output_directory.hpp"

#include <cstddef>
#include <fstream>
#include <future>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
std::string read(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(OutputDirectory, AppearsWholeOrNotAtAll) {
  const strata::test::TemporaryDirectory folder;
  StagedPaths staged;
  {
    OutputDirectory out(folder.path() / "maps", staged);
    write(out.path() / "a", "1");
    EXPECT_FALSE(fs::exists(folder.path() / "maps"));
  }
  EXPECT_EQ(entries(folder.path()), 0U);
  OutputDirectory out(folder.path() / "maps", staged);
  write(out.path() / "a", "1");
  out.commit();
  EXPECT_EQ(read(folder.path() / "maps" / "a"), "1");
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(OutputDirectory, ReplacesItsOwnEntriesAndLeavesOthersAlone) {
  const strata::test::TemporaryDirectory folder;
  StagedPaths staged;
  fs::create_directories(folder.path() / "maps" / "patches");
  write(folder.path() / "maps" / "mine.txt", "mine");
  write(folder.path() / "maps" / "a", "old");
  write(folder.path() / "maps" / "patches" / "stale", "old");
  OutputDirectory out(folder.path() / "maps", staged);
  write(out.path() / "a", "new");
  fs::create_directory(out.path() / "patches");
  out.commit();
  EXPECT_EQ(read(folder.path() / "maps" / "mine.txt"), "mine");
  EXPECT_EQ(read(folder.path() / "maps" / "a"), "new");
  EXPECT_EQ(entries(folder.path() / "maps" / "patches"), 0U);
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(OutputDirectory, AHardEndRemovesWhatIsUnderWay) {
  const strata::test::TemporaryDirectory folder;
  StagedPaths staged;
  OutputDirectory out(folder.path() / "maps", staged);
  write(out.path() / "a", "1");
  staged.remove_all();
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(OutputDirectory, AHardEndWaitsUntilWhatIsBeingPutInPlaceIsThere) {
  const strata::test::TemporaryDirectory folder;
  StagedPaths staged;
  const fs::path path = folder.path() / "aside";
  write(path, "1");
  staged.add(path);
  std::future<void> hard_end;
  staged.put_in_place(path, [&] {
    hard_end = std::async(std::launch::async, [&] { staged.remove_all(); });
    EXPECT_EQ(hard_end.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
    fs::rename(path, folder.path() / "there");
  });
  hard_end.get();
  EXPECT_EQ(read(folder.path() / "there"), "1");
}

TEST(OutputDirectory, AFileInTheWayIsNamed) {
  const strata::test::TemporaryDirectory folder;
  StagedPaths staged;
  write(folder.path() / "maps", "a file");
  EXPECT_THROW(OutputDirectory(folder.path() / "maps", staged), OutputError);
  EXPECT_EQ(read(folder.path() / "maps"), "a file");
}

}  // namespace
}  // namespace strata::tools
