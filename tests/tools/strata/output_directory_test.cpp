// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/output_directory.hpp"

#include <csignal>
#include <cstddef>
#include <fstream>
#include <future>
#include <iterator>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/watched_disk.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(OutputDirectory, AppearsWholeOrNotAtAll) {
  const test::TemporaryDirectory folder;
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
  EXPECT_EQ(test::bytes_of(folder.path() / "maps" / "a"), "1");
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(OutputDirectory, ReplacesItsOwnEntriesAndLeavesOthersAlone) {
  const test::TemporaryDirectory folder;
  StagedPaths staged;
  fs::create_directories(folder.path() / "maps" / "patches");
  write(folder.path() / "maps" / "mine.txt", "mine");
  write(folder.path() / "maps" / "a", "old");
  write(folder.path() / "maps" / "patches" / "stale", "old");
  OutputDirectory out(folder.path() / "maps", staged);
  write(out.path() / "a", "new");
  fs::create_directory(out.path() / "patches");
  out.commit();
  EXPECT_EQ(test::bytes_of(folder.path() / "maps" / "mine.txt"), "mine");
  EXPECT_EQ(test::bytes_of(folder.path() / "maps" / "a"), "new");
  EXPECT_EQ(entries(folder.path() / "maps" / "patches"), 0U);
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(OutputDirectory, AHardEndRemovesWhatIsUnderWay) {
  const test::TemporaryDirectory folder;
  StagedPaths staged;
  OutputDirectory out(folder.path() / "maps", staged);
  write(out.path() / "a", "1");
  staged.remove_all();
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(OutputDirectory, AHardEndWaitsUntilWhatIsBeingPutInPlaceIsThere) {
  const test::TemporaryDirectory folder;
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
  EXPECT_EQ(test::bytes_of(folder.path() / "there"), "1");
}

/// A target with an entry of its own, one that is to be replaced, and a folder of each kind.
void make_old(const fs::path& target) {
  fs::create_directories(target / "patches");
  fs::create_directories(target / "mine" / "deep");
  write(target / "mine" / "deep" / "note", "mine");
  fs::create_symlink("mine/deep", target / "link");
  write(target / "a", "old");
  write(target / "b", "old");
  write(target / "patches" / "old", "old");
}

void write_new(const OutputDirectory& out) {
  write(out.path() / "a", "new");
  write(out.path() / "b", "new");
  fs::create_directory(out.path() / "patches");
  write(out.path() / "patches" / "new", "new");
}

/// "old" or "new"; a mixture fails.
std::string state_of(const fs::path& target) {
  const std::string state = test::bytes_of(target / "a");
  EXPECT_EQ(test::bytes_of(target / "b"), state);
  EXPECT_EQ(test::bytes_of(target / "patches" / state), state);
  EXPECT_EQ(entries(target / "patches"), 1U);
  EXPECT_EQ(test::bytes_of(target / "link" / "note"), "mine");
  EXPECT_EQ(entries(target), 5U);
  return state;
}

/// In a process of its own that is killed before a step; whether that came.
bool replace_killed_before(std::size_t step, const fs::path& target, bool can_exchange) {
  const pid_t child = fork();
  if (child == 0) {
    test::WatchedDisk disk;
    disk.can_exchange = can_exchange;
    disk.before_step = [step](std::size_t now) {
      if (now == step) (void)raise(SIGKILL);
    };
    StagedPaths staged;
    OutputDirectory out(target, staged, disk);
    write_new(out);
    out.commit();
    _exit(0);
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFSIGNALED(status);
}

/// What is there after a kill before each step, the next run having put back what it finds.
std::set<std::string> states_after_kills(bool can_exchange) {
  std::size_t step = 0;
  std::set<std::string> states;
  for (bool is_killed = true; is_killed; ++step) {
    const test::TemporaryDirectory folder;
    const fs::path target = folder.path() / "maps";
    make_old(target);
    is_killed = replace_killed_before(step, target, can_exchange);
    if (!fs::exists(target)) states.insert("without a name");
    if (!can_exchange) OutputDirectory::put_back(target);
    states.insert(state_of(target));
  }
  return states;
}

TEST(OutputDirectory, AKillLeavesTheOldFolderOrTheNewOne) {
  EXPECT_EQ(states_after_kills(true), (std::set<std::string>{"old", "new"}));
}

TEST(OutputDirectory, AKillWhereTwoNamesCannotBeExchangedIsMendedByTheNextOne) {
  EXPECT_EQ(states_after_kills(false), (std::set<std::string>{"old", "without a name", "new"}));
}

TEST(OutputDirectory, IsOnTheDiskBeforeItTakesItsNameAndTheOldOneGoesAfterThat) {
  const test::TemporaryDirectory folder;
  fs::create_directory(folder.path() / "maps");
  write(folder.path() / "maps" / "a", "old");
  const test::WatchedDisk disk;
  StagedPaths staged;
  OutputDirectory out(folder.path() / "maps", staged, disk);
  write(out.path() / "a", "new");
  out.commit();
  EXPECT_THAT(
      disk.steps(),
      ::testing::ElementsAre("sync a", "sync .maps.partial", "exchange .maps.partial and maps",
                             "sync " + folder.path().filename().string(), "remove .maps.partial"));
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(OutputDirectory, KeepsTheFolderThatItsCallerStandsIn) {
  const test::TemporaryDirectory folder;
  make_old(folder.path() / "maps");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path() / "maps");
  StagedPaths staged;
  OutputDirectory out(".", staged);
  write_new(out);
  out.commit();
  EXPECT_EQ(state_of(fs::current_path()), "new");
  EXPECT_EQ(fs::current_path(), folder.path() / "maps");
  fs::current_path(before);
  EXPECT_EQ(state_of(folder.path() / "maps"), "new");
}

TEST(OutputDirectory, FollowsALinkToTheFolderAndLeavesItALink) {
  const test::TemporaryDirectory folder;
  make_old(folder.path() / "monday");
  fs::create_directory_symlink("monday", folder.path() / "maps");
  StagedPaths staged;
  OutputDirectory out(folder.path() / "maps", staged);
  write_new(out);
  out.commit();
  EXPECT_TRUE(fs::is_symlink(folder.path() / "maps"));
  EXPECT_EQ(state_of(folder.path() / "monday"), "new");
}

TEST(OutputDirectory, TakesAwayTheFoldersThatItMadeAboveItself) {
  const test::TemporaryDirectory folder;
  StagedPaths staged;
  { OutputDirectory out(folder.path() / "a" / "b" / "maps", staged); }
  EXPECT_EQ(entries(folder.path()), 0U);
  fs::create_directory(folder.path() / "a");
  { OutputDirectory out(folder.path() / "a" / "b" / "maps", staged); }
  EXPECT_EQ(entries(folder.path() / "a"), 0U) << "what was there stays";
  OutputDirectory out(folder.path() / "a" / "b" / "maps", staged);
  out.commit();
  EXPECT_TRUE(fs::is_directory(folder.path() / "a" / "b" / "maps"));
}

TEST(OutputDirectory, AFileInTheWayIsNamed) {
  const test::TemporaryDirectory folder;
  StagedPaths staged;
  write(folder.path() / "maps", "a file");
  EXPECT_THROW(OutputDirectory(folder.path() / "maps", staged), OutputError);
  EXPECT_EQ(test::bytes_of(folder.path() / "maps"), "a file");
  EXPECT_THROW(OutputDirectory(folder.path() / "maps" / "below", staged), OutputError);
  EXPECT_THROW(OutputDirectory(folder.path() / std::string(300, 'n'), staged), OutputError);
  EXPECT_EQ(entries(folder.path()), 1U);
}

}  // namespace
}  // namespace strata::tools
