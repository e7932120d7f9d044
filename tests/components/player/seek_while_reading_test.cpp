// SPDX-License-Identifier: Apache-2.0
/// A player that is asked while a seek reads the bag.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/components/player/player_services.hpp"

namespace strata::player {
namespace {

/// A pipe instead of the bag's file: who opens it waits for a writer, and reads until that is gone.
class Pipe {
 public:
  explicit Pipe(std::filesystem::path file) : file_(std::move(file)) {
    std::filesystem::remove(file_);
    if (mkfifo(file_.c_str(), 0600) != 0) throw std::runtime_error("no pipe at " + file_.string());
  }
  ~Pipe() { close_writer(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  /// Lets the reader that waits, or comes within 20 s, open it; false when none comes, or when
  /// `is_over`.
  bool open_writer(const std::function<bool()>& is_over) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (writer_ < 0 && !is_over() && std::chrono::steady_clock::now() < deadline) {
      writer_ = open(file_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
      if (writer_ < 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return writer_ >= 0;
  }
  void close_writer() {
    if (writer_ >= 0) close(writer_);
    writer_ = -1;
  }

 private:
  std::filesystem::path file_;
  int writer_ = -1;
};

bool is_ready(const std::future<bool>& future) {
  return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

/// Lets who reads the pipe go on, however often they look at it, until all are answered.
void let_go(Pipe& pipe, const std::vector<std::future<bool>*>& answers) {
  const auto are_answered = [&] {
    return std::all_of(answers.begin(), answers.end(),
                       [](const std::future<bool>* answer) { return is_ready(*answer); });
  };
  do {
    pipe.close_writer();
  } while (pipe.open_writer(are_answered));
}

/// Where seeking reads the bag.
class PlayerServicesOfMessages : public PlayerServices {};

TEST_P(PlayerServicesOfMessages, AnswerWhileASeekReads) {
  start(", paused: true");
  EXPECT_TRUE(play_next());
  Pipe pipe(bag() / "bag_0.db3");
  auto sought = begin_to_seek(18.0);
  ASSERT_TRUE(pipe.open_writer([] { return false; })) << "it seeks now, until the writer is gone";
  EXPECT_TRUE(is_paused());
  EXPECT_EQ(rate(), 1.0);
  EXPECT_TRUE(set_rate(2.0));
  EXPECT_EQ(parameter("rate").double_value(), 2.0);
  EXPECT_EQ(played(1), first(1));
  let_go(pipe, {&sought});
  EXPECT_FALSE(sought.get()) << "there is no bag any more";
  EXPECT_EQ(take_errors().size(), 1U);
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(2), first(2)) << "goes on where it was";
}

TEST_P(PlayerServicesOfMessages, GoOnWhereTheyWereWhenASeekIsRefusedHoweverLongItRead) {
  start(", rate: 0.001");
  EXPECT_EQ(played(1), first(1));
  Pipe pipe(bag() / "bag_0.db3");
  auto sought = begin_to_seek(18.0);
  ASSERT_TRUE(pipe.open_writer([] { return false; }));
  EXPECT_TRUE(set_rate(1e6));  // from here to there is far beyond the end
  EXPECT_TRUE(set_rate(0.001));
  let_go(pipe, {&sought});
  EXPECT_FALSE(sought.get());
  EXPECT_EQ(take_errors().size(), 1U);
  pause();
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(2), first(2)) << "nothing was caught up with";
}

TEST_P(PlayerServicesOfMessages, RefuseASeekThatWaitsWhenAnotherComes) {
  start(", paused: true");
  Pipe pipe(bag() / "bag_0.db3");
  auto held = begin_to_seek(18.0);
  ASSERT_TRUE(pipe.open_writer([] { return false; }));
  std::vector<std::future<bool>> waiting;
  waiting.push_back(begin_to_seek(3.0));
  waiting.push_back(begin_to_seek(5.0));
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  const auto answered = [&] { return std::count_if(waiting.begin(), waiting.end(), is_ready); };
  while (answered() == 0 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(answered(), 1) << "the one that came first";
  EXPECT_FALSE(is_ready(held)) << "it is not held up by what reads";
  let_go(pipe, {&held, waiting.data(), waiting.data() + 1});
  EXPECT_FALSE(held.get());
  for (auto& answer : waiting) EXPECT_FALSE(answer.get());
  EXPECT_EQ(take_errors().size(), 2U) << "of the two that were tried";
}

INSTANTIATE_TEST_SUITE_P(All, PlayerServicesOfMessages, testing::Values("messages"));

}  // namespace
}  // namespace strata::player
