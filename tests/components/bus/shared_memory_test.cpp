// SPDX-License-Identifier: Apache-2.0
/// Which files of Fast DDS in shared memory are cleared away, and which are not.
#include "components/bus/shared_memory.hpp"

#include <fstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "tests/components/bus/domain.hpp"
#include "tests/support/shared_segments.hpp"
#include "tests/support/test_data.hpp"

namespace strata::bus {
namespace {

namespace fs = std::filesystem;

class SharedMemory : public testing::Test {
 protected:
  const test::TemporaryDirectory folder_;
  const std::string segment_ = "fastrtps_974d27f10541dd8f";

  fs::path make(const std::string& name, std::chrono::seconds age, std::size_t bytes = 100) const {
    const fs::path file = folder_.path() / name;
    std::ofstream(file) << std::string(bytes, 'x');
    fs::last_write_time(file, fs::file_time_type::clock::now() - age);
    return file;
  }
  void SetUp() override {
    make(segment_, std::chrono::hours(1));
    make(segment_ + "_el", std::chrono::hours(1), 0);
  }
  [[nodiscard]] bool is_there() const {
    return fs::exists(folder_.path() / segment_) && fs::exists(folder_.path() / (segment_ + "_el"));
  }
};

TEST_F(SharedMemory, OfAProcessThatDiedIsRemoved) {
  const SweptMemory swept = remove_orphaned_segments(folder_.path());
  EXPECT_EQ(swept.segments, 1U);
  EXPECT_EQ(swept.bytes, 100U);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(SharedMemory, OfALivingProcessIsKept) {
  const int lock = open((folder_.path() / (segment_ + "_el")).c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);
  EXPECT_EQ(remove_orphaned_segments(folder_.path()).segments, 0U);
  EXPECT_TRUE(is_there());
  close(lock);
  EXPECT_EQ(remove_orphaned_segments(folder_.path()).segments, 1U);
}

TEST_F(SharedMemory, ThatIsJustBeingMadeIsKept) {
  make(segment_ + "_el", std::chrono::seconds(1), 0);
  EXPECT_EQ(remove_orphaned_segments(folder_.path()).segments, 0U);
  EXPECT_TRUE(is_there());
}

TEST_F(SharedMemory, OfOthersIsKept) {
  const auto old = std::chrono::hours(1);
  std::vector<fs::path> kept;
  for (const char* name :
       {"fastrtps_port7410", "fastrtps_port7410_el", "fastrtps_port7410_sl",
        "sem.fastrtps_port7410_mutex", "fastrtps_974d27f10541dd8", "fastrtps_974d27f10541dd8_el",
        "fastrtps_974d27f10541ddxx_el", "someone_974d27f10541dd8f_el"}) {
    kept.push_back(make(name, old));
  }
  EXPECT_EQ(remove_orphaned_segments(folder_.path()).segments, 1U);
  for (const fs::path& file : kept) EXPECT_TRUE(fs::exists(file)) << file;
}

TEST_F(SharedMemory, ThatIsNotThereIsNoError) {
  EXPECT_EQ(remove_orphaned_segments(folder_.path() / "nowhere").segments, 0U);
}

TEST_F(SharedMemory, OfARunningParticipantSurvivesTheStartOfAnother) {
  const auto first = test::make_participant(Transport::kSharedMemory);
  const auto locks = test::segment_locks_of("self");
  ASSERT_FALSE(locks.empty());
  for (const fs::path& lock : locks) {
    fs::last_write_time(lock, fs::file_time_type::clock::now() - std::chrono::hours(1));
  }
  const auto second = test::make_participant(Transport::kSharedMemory);
  for (const fs::path& lock : locks) {
    EXPECT_TRUE(fs::exists(lock)) << lock;
    EXPECT_TRUE(fs::exists(test::segment_of_lock(lock))) << lock;
  }
}

}  // namespace
}  // namespace strata::bus
