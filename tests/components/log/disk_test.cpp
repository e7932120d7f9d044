// SPDX-License-Identifier: Apache-2.0
/// In which order what is written reaches the disk.
#include "components/log/disk.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "components/log/state_store.hpp"
#include "components/log/whole_file.hpp"
#include "components/log/whole_folder.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/watched_disk.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class WhatIsWritten : public ::testing::Test {
 protected:
  [[nodiscard]] std::string folder_name() const { return folder_.path().filename().string(); }
  const test::TemporaryDirectory folder_;
  test::WatchedDisk disk_;
};

TEST_F(WhatIsWritten, InAFileIsOnTheDiskBeforeItsNameAndThatBeforeTheEnd) {
  WholeFile file(folder_.path() / "map.yaml", disk_);
  file.stream() << "new";
  EXPECT_THAT(disk_.steps(), IsEmpty());
  file.commit();
  EXPECT_THAT(disk_.steps(),
              ElementsAre("sync .map.yaml.partial", "rename .map.yaml.partial to map.yaml",
                          "sync " + folder_name()));
  EXPECT_EQ(fs::file_size(folder_.path() / "map.yaml"), 3U);
}

TEST_F(WhatIsWritten, InAStateFileIsSyncedToo) {
  write_state_file(folder_.path() / "a.state", Bytes(100, 1), disk_);
  EXPECT_THAT(disk_.steps(),
              ElementsAre("sync .a.state.partial", "rename .a.state.partial to a.state",
                          "sync " + folder_name()));
}

TEST_F(WhatIsWritten, InAFolderIsOnTheDiskBeforeItsName) {
  WholeFolder whole(folder_.path() / "bag", disk_);
  fs::create_directories(whole.aside() / "inner");
  std::ofstream(whole.aside() / "b") << "1";
  std::ofstream(whole.aside() / "inner" / "c") << "2";
  WholeFile(whole.aside() / "a", disk_).commit();
  EXPECT_THAT(disk_.steps(), ElementsAre("rename .a.partial to a")) << "synced with the folder";
  whole.commit();
  EXPECT_THAT(disk_.steps(), ElementsAre("rename .a.partial to a", "sync a", "sync b", "sync inner",
                                         "sync c", "sync .bag.partial",
                                         "rename .bag.partial to bag", "sync " + folder_name()));
}

TEST_F(WhatIsWritten, LeavesTheOldContentWhenItCannotBeSynced) {
  const fs::path path = folder_.path() / "map.yaml";
  std::ofstream(path) << "old content";
  disk_.before_step = [&](std::size_t) { throw OutputError(path.string(), "no disk", "mend it"); };
  {
    WholeFile file(path, disk_);
    file.stream() << "new";
    EXPECT_THROW(file.commit(), OutputError);
  }
  EXPECT_EQ(fs::file_size(path), 11U);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(WhatIsWritten, ByAProcessThatIsGoneIsTakenAwayByTheNext) {
  const pid_t gone = fork();
  if (gone == 0) _exit(0);
  int status = 0;
  ASSERT_EQ(waitpid(gone, &status, 0), gone);
  const auto left = [&](const std::string& mark) {
    return folder_.path() / (".kb.partial-" + mark);
  };
  const std::vector<fs::path> others{left(std::to_string(getppid())), left("mine"),
                                     folder_.path() / (".kb2.partial-" + std::to_string(gone))};
  for (const fs::path& other : others) fs::create_directory(other);
  const auto leave = [&] { fs::create_directories(left(std::to_string(gone)) / "inner"); };
  leave();
  { const WholeFile file(folder_.path() / "kb"); }
  EXPECT_FALSE(fs::exists(left(std::to_string(gone))));
  leave();
  { const WholeFolder folder(folder_.path() / "kb"); }
  EXPECT_FALSE(fs::exists(left(std::to_string(gone))));
  for (const fs::path& other : others) EXPECT_TRUE(fs::exists(other)) << other;
}

TEST_F(WhatIsWritten, ByAProcessThatNobodyAskedHowItEndedIsTakenAwayToo) {
  const pid_t ended = fork();
  if (ended == 0) _exit(0);
  siginfo_t how{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(ended), &how, WEXITED | WNOWAIT), 0);
  const fs::path left = folder_.path() / (".kb.partial-" + std::to_string(ended));
  fs::create_directory(left);
  remove_left_over(folder_.path() / "kb");
  EXPECT_FALSE(fs::exists(left));
  int status = 0;
  EXPECT_EQ(waitpid(ended, &status, 0), ended);
}

TEST_F(WhatIsWritten, CanTakeAnothersPlaceAndGiveItsOwn) {
  const fs::path a = folder_.path() / "a";
  const fs::path b = folder_.path() / "b";
  fs::create_directory(a);
  std::ofstream(b) << "file";
  ASSERT_TRUE(disk_.exchange(a, b)) << "needs a file system that can exchange two names";
  EXPECT_TRUE(fs::is_regular_file(a));
  EXPECT_TRUE(fs::is_directory(b));
  EXPECT_THROW((void)disk_.exchange(a, folder_.path() / "missing"), OutputError);
}

}  // namespace
}  // namespace strata::log
