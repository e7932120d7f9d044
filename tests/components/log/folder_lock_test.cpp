// SPDX-License-Identifier: Apache-2.0
#include "components/log/folder_lock.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

TEST(FolderLock, IsHeldByOneAndSaysByWhom) {
  const test::TemporaryDirectory folder;
  const fs::path maps = folder.path() / "maps";
  std::vector<std::string> holders;
  const auto give_up = [&](const std::string& holder) {
    holders.push_back(holder);
    return false;
  };
  {
    const FolderLock first(maps, give_up);
    EXPECT_THROW(FolderLock(folder.path() / "." / "maps" / "", give_up), Cancelled);
    EXPECT_NO_THROW(FolderLock(folder.path() / "others", give_up));
  }
  EXPECT_THAT(holders, ::testing::ElementsAre("process " + std::to_string(getpid())));
  EXPECT_NO_THROW(FolderLock(maps, give_up));
  EXPECT_TRUE(fs::is_empty(folder.path())) << "nothing is left";
}

TEST(FolderLock, IsFreeAfterAKillAndGoesToWhoWaits) {
  const test::TemporaryDirectory folder;
  const fs::path maps = folder.path() / "maps";
  const pid_t holder = fork();
  if (holder == 0) {
    const FolderLock lock(maps, [](const std::string&) { return false; });
    std::ofstream(folder.path() / "held").close();
    for (;;) pause();
  }
  ASSERT_TRUE(test::comes_true([&] { return fs::exists(folder.path() / "held"); }));
  std::string told;
  const FolderLock lock(maps, [&](const std::string& who) {
    told = who;
    (void)kill(holder, SIGKILL);
    int status = 0;
    (void)waitpid(holder, &status, 0);
    return true;
  });
  EXPECT_EQ(told, "process " + std::to_string(holder));
}

}  // namespace
}  // namespace strata::log
