// SPDX-License-Identifier: Apache-2.0
/// The store while a robot runs: killed at any moment, out of space, shared by two programs.
#include <csignal>
#include <cstdint>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "memory/store/store.hpp"
#include "tests/memory/nodes/room_world.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

constexpr StoreOptions kQuick{.check = false};

TimescaleConfig small_config() {
  TimescaleConfig config;
  config.angle_bins = 60;
  config.levels = {{"short", 5, 3.1}, {"mid", 20, 27.0}, {"daily", 10, 27.0, 3.0}};
  return config;
}

/// The k-th scan of a robot that goes to and fro, one a second.
PosedScan scan_of(std::uint64_t k) {
  const auto t = static_cast<double>(k);
  return observe({-0.5 + 2.0 * std::sin(0.1 * t), 0.3, 0.05 * t}, t, k % 20 < 10);
}

/// A memory that has taken in n scans and nothing else; grows by need.
class Reference {
 public:
  std::vector<std::byte> state_after(std::uint64_t n) {
    if (n < memory_.observations()) memory_ = TimescaleMemory(small_config());
    while (memory_.observations() < n) memory_.observe(scan_of(memory_.observations()));
    return memory_.state();
  }

 private:
  TimescaleMemory memory_{small_config()};
};

/// Goes on where the store stopped and saves each scan, with one node loaded at a time; tells the
/// pipe how many are safe. Never returns.
[[noreturn]] void run_robot(const std::filesystem::path& path, int pipe) {
  Store store(path, kQuick);
  TimescaleMemory memory =
      store.has_timescale() ? store.open_timescale() : TimescaleMemory(small_config());
  SavedTimescale saved = store.has_timescale() ? Store::all_saved(memory) : SavedTimescale();
  while (true) {
    memory.observe(scan_of(memory.observations()));
    store.save_timescale_changes(memory, saved);
    memory.evict(1, store.timescale_nodes());
    const std::uint64_t safe = memory.observations();
    if (write(pipe, &safe, sizeof safe) != sizeof safe) _exit(1);
  }
}

struct Killed {
  std::uint64_t safe = 0;  ///< what the robot knew to be saved
  int status = 0;
};

/// Lets a robot run in its own process and kills it after it has saved `scans` more and a moment.
Killed run_and_kill(const std::filesystem::path& path, std::uint64_t scans, std::uint32_t wait_us) {
  int ends[2] = {-1, -1};
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t robot = fork();
  if (robot == 0) {
    close(ends[0]);
    try {
      run_robot(path, ends[1]);
    } catch (...) {
      _exit(2);
    }
  }
  close(ends[1]);
  Killed result;
  for (std::uint64_t k = 0; k < scans; ++k) {
    if (read(ends[0], &result.safe, sizeof result.safe) <= 0) break;
  }
  usleep(wait_us);
  kill(robot, SIGKILL);
  waitpid(robot, &result.status, 0);
  // What it could still say before it died.
  while (read(ends[0], &result.safe, sizeof result.safe) > 0) {
  }
  close(ends[0]);
  return result;
}

TEST(StoreUnderFire, LosesNothingThatWasSavedInTwoHundredKills) {
  const test::TemporaryDirectory directory;
  const auto path = directory.path() / "strata.db";
  RandomStream random(11, StreamId::kTest);
  Reference reference;
  std::uint64_t last = 0;
  int with_pending_log = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Killed killed = run_and_kill(path, 1 + random.below(3), random.below(3000));
    ASSERT_TRUE(WIFSIGNALED(killed.status) && WTERMSIG(killed.status) == SIGKILL) << trial;
    with_pending_log += std::filesystem::exists(path.string() + "-wal") ? 1 : 0;
    const Store store(path, {.check = trial % 20 == 0});
    const TimescaleMemory memory = store.load_timescale();
    // The last transaction may be whole although the robot did not live to say so.
    ASSERT_GE(memory.observations(), killed.safe) << trial;
    ASSERT_LE(memory.observations(), killed.safe + 1) << trial;
    ASSERT_GT(memory.observations(), last) << trial;
    last = memory.observations();
    ASSERT_EQ(memory.state(), reference.state_after(last)) << trial;
  }
  EXPECT_GT(with_pending_log, 150);
}

TEST(StoreUnderFire, WritesOnlyWhatHasChanged) {
  const test::TemporaryDirectory directory;
  Store store(directory.path() / "strata.db");
  TimescaleMemory memory(small_config());
  SavedTimescale saved;
  for (std::uint64_t k = 0; k < 60; ++k) memory.observe(scan_of(k));
  ASSERT_GE(memory.nodes().size(), 3U);
  EXPECT_EQ(store.save_timescale_changes(memory, saved), memory.nodes().size());
  EXPECT_EQ(store.save_timescale_changes(memory, saved), 0U);
  memory.observe(scan_of(60));
  EXPECT_EQ(store.save_timescale_changes(memory, saved), 1U);
  memory.close_day();
  EXPECT_EQ(store.save_timescale_changes(memory, saved), memory.nodes().size());
  EXPECT_EQ(store.load_timescale().state(), memory.state());
}

TEST(StoreUnderFire, TellsTwoProgramsThatWriteOneMemoryApart) {
  const test::TemporaryDirectory directory;
  const auto path = directory.path() / "strata.db";
  Store first(path);
  Store second(path);
  TimescaleMemory mine(small_config());
  TimescaleMemory theirs(small_config());
  SavedTimescale my_save;
  SavedTimescale their_save;
  mine.observe(scan_of(0));
  theirs.observe(scan_of(5));
  first.save_timescale_changes(mine, my_save);
  try {
    second.save_timescale_changes(theirs, their_save);
    FAIL() << "mixed two memories";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("another program"));
    EXPECT_THAT(error.remedy(), testing::HasSubstr("one program"));
  }
  EXPECT_EQ(second.load_timescale().state(), mine.state());
  mine.observe(scan_of(1));
  EXPECT_EQ(first.save_timescale_changes(mine, my_save), 1U);
}

/// Runs the body in a process of its own; its exit status.
int in_a_process(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      _exit(body());
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      _exit(99);
    } catch (...) {
      _exit(99);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(StoreUnderFire, KeepsTheLastStateWhenTheDiskIsFullAndGoesOnAfterwards) {
  const test::TemporaryDirectory directory;
  const auto path = directory.path() / "strata.db";
  // No file may grow beyond 200 kB: what a full disk does, for this process only.
  const int exit_status = in_a_process([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    Store store(path, kQuick);
    TimescaleMemory memory(small_config());
    SavedTimescale saved;
    rlimit limit{};
    getrlimit(RLIMIT_FSIZE, &limit);
    const rlimit unlimited = limit;
    limit.rlim_cur = 200'000;
    setrlimit(RLIMIT_FSIZE, &limit);
    std::uint64_t safe = 0;
    try {
      while (true) {
        memory.observe(scan_of(memory.observations()));
        store.save_timescale_changes(memory, saved);
        safe = memory.observations();
      }
    } catch (const OutputError& error) {
      if (error.remedy().empty()) return 2;
    }
    if (safe == 0 || saved.observations != safe) return 3;
    {
      // Whoever looks now finds the last state that was saved.
      const TimescaleMemory stored = Store(path, kQuick).load_timescale();
      if (stored.observations() != safe) return 4;
    }
    setrlimit(RLIMIT_FSIZE, &unlimited);
    store.save_timescale_changes(memory, saved);
    return store.load_timescale().state() == memory.state() ? 0 : 5;
  });
  EXPECT_EQ(exit_status, 0);
  const TimescaleMemory stored = Store(path).load_timescale();
  EXPECT_EQ(stored.state(), Reference().state_after(stored.observations()));
}

/// The state of the memory in the store, or why there is none.
std::string read_or_error(const std::filesystem::path& path, const std::vector<std::byte>& truth) {
  try {
    const Store store(path, {.read_only = true});
    return store.load_timescale().state() == truth ? "same" : "another state";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(StoreUnderFire, IsReadWhereNothingMayBeWrittenAndSaysSoWhenWriting) {
  const test::TemporaryDirectory directory;
  const auto folder = directory.path() / "disk";
  std::filesystem::create_directory(folder);
  const auto path = folder / "strata.db";
  TimescaleMemory memory(small_config());
  for (std::uint64_t k = 0; k < 20; ++k) memory.observe(scan_of(k));
  Store(path).save_timescale(memory);
  using std::filesystem::perms;
  std::filesystem::permissions(directory.path(), perms::owner_all | perms::others_exec);
  std::filesystem::permissions(path, perms::owner_read | perms::others_read);
  std::filesystem::permissions(
      folder, perms::owner_read | perms::owner_exec | perms::others_read | perms::others_exec);
  const int exit_status = in_a_process([&] {
    constexpr uid_t kNobody = 65534;  // root may write everything
    if (geteuid() == 0 && (setgid(kNobody) != 0 || setuid(kNobody) != 0)) return 2;
    if (read_or_error(path, memory.state()) != "same") return 3;
    try {
      Store store(path);
      store.save_timescale(memory);
      return 4;
    } catch (const OutputError& error) {
      const std::string what = error.what();
      if (what.find("strata.db") == std::string::npos || error.remedy().empty()) return 5;
      if (what.find("may not be written") == std::string::npos) return 6;
    }
    return read_or_error(path, memory.state()) == "same" ? 0 : 7;
  });
  EXPECT_EQ(exit_status, 0);
  std::filesystem::permissions(folder, perms::owner_all);
}

}  // namespace
}  // namespace strata::memory
