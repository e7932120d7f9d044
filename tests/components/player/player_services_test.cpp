// SPDX-License-Identifier: Apache-2.0
/// A player under the control of others, by the services of rosbag2's player and by parameters.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "components/bus/bag_service_types.hpp"
#include "components/bus/service.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/runtime/parameters.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/support/test_data.hpp"

namespace strata::player {
namespace {

using runtime::parameter_value;
using sensor_msgs::msg::LaserScan;

constexpr int kScans = 20;

class PlayerServices : public testing::TestWithParam<const char*> {
 protected:
  void start(const std::string& parameters) {
    test::write_drive(bag(), kScans);
    host_ = test::play(bag(), std::string(", topics: [/scan], mode: ") + GetParam() + parameters,
                       participant_);
    host_->activate();
  }
  [[nodiscard]] std::filesystem::path bag() const { return folder_.path() / "bag"; }
  std::vector<std::string> take_errors() { return host_->take_errors(); }
  void TearDown() override {
    if (host_) {
      EXPECT_TRUE(host_->take_errors().empty());
    }
  }
  /// The answer to a call; an empty one when there is none, which fails the test.
  template <typename S>
  typename bus::ServiceType<S>::Response call(
      const std::string& name, const typename bus::ServiceType<S>::Request& request = {},
      std::chrono::seconds patience = std::chrono::seconds(20)) {
    const auto response = bus::call_service<S>(participant_, "/player/" + name, request, patience);
    EXPECT_TRUE(response.has_value()) << name;
    return response.value_or(typename bus::ServiceType<S>::Response());
  }
  void pause() { call<bus::srv::Pause>("pause"); }
  void resume() { call<bus::srv::Resume>("resume"); }
  bool is_paused() { return call<bus::srv::IsPaused>("is_paused").paused(); }
  bool play_next() { return call<bus::srv::PlayNext>("play_next").success(); }
  double rate() { return call<bus::srv::GetRate>("get_rate").rate(); }
  bool set_rate(double rate) {
    rosbag2_interfaces::srv::SetRate_Request request;
    request.rate(rate);
    return call<bus::srv::SetRate>("set_rate", request).success();
  }
  bool seek(double seconds, std::chrono::seconds patience = std::chrono::seconds(20)) {
    rosbag2_interfaces::srv::Seek_Request request;
    request.time(convert::to_message(Stamp::from_seconds(seconds)));
    return call<bus::srv::Seek>("seek", request, patience).success();
  }
  /// Of a seek that is held open, and with it all that is done meanwhile.
  std::future<bool> begin_to_seek(double seconds) {
    return std::async(std::launch::async,
                      [this, seconds] { return seek(seconds, std::chrono::seconds(60)); });
  }
  bool set_parameter(const std::string& name, rcl_interfaces::msg::ParameterValue value) {
    rcl_interfaces::srv::SetParameters_Request request;
    request.parameters({runtime::parameter(name, std::move(value))});
    const auto response = call<bus::srv::SetParameters>("set_parameters", request);
    // Neither refused nor put off until the next configure.
    return response.results().at(0).successful() && response.results()[0].reason().empty();
  }
  rcl_interfaces::msg::ParameterValue parameter(const std::string& name) {
    rcl_interfaces::srv::GetParameters_Request request;
    request.names({name});
    return call<bus::srv::GetParameters>("get_parameters", request).values().at(0);
  }
  /// The numbers of the scans that came, at least `count`.
  std::vector<int> played(std::size_t count) {
    std::vector<int> numbers;
    for (const LaserScan& scan : scans_.wait_for(count)) {
      numbers.push_back(static_cast<int>(scan.ranges()[2]) - 3);
    }
    return numbers;
  }

 private:
  test::TemporaryDirectory folder_;
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  test::Collector<LaserScan> scans_{participant_, "/scan", "lossless"};
  std::unique_ptr<runtime::Host> host_;
};

std::vector<int> first(int count) {
  std::vector<int> numbers;
  for (int i = 0; i < count; ++i) numbers.push_back(i);
  return numbers;
}

TEST_P(PlayerServices, PlayNextStepByStepWhilePausedAndTheRestWhenResumed) {
  start(", paused: true, rate: 0.001");
  EXPECT_TRUE(is_paused());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(play_next()) << i;
  EXPECT_EQ(played(3), first(3));
  resume();
  EXPECT_FALSE(is_paused());
  EXPECT_FALSE(play_next()) << "it plays by itself, if slowly";
  EXPECT_TRUE(set_rate(1e6));
  EXPECT_EQ(played(kScans), first(kScans));
  call<bus::srv::TogglePaused>("toggle_paused");
  EXPECT_TRUE(is_paused());
  EXPECT_FALSE(play_next()) << "nothing is left";
}

TEST_P(PlayerServices, PauseInTheMiddleOfALog) {
  start(", loop: true, rate: 1000");
  ASSERT_GE(played(5).size(), 5U);
  pause();
  const std::vector<int> before = played(5);  // delivered while they are written
  EXPECT_TRUE(is_paused());
  EXPECT_TRUE(play_next());
  EXPECT_TRUE(play_next());
  const std::vector<int> after = played(before.size() + 2);
  ASSERT_EQ(after.size(), before.size() + 2) << "nothing was played between pause and play_next";
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i], static_cast<int>(i % kScans)) << i;
  }
}

TEST_P(PlayerServices, SeekAPlaceByItsStamp) {
  start(", paused: true");
  EXPECT_TRUE(seek(17.5));
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(1).back(), 17);
  EXPECT_TRUE(seek(3.0));
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(2).back(), 2);
  EXPECT_FALSE(seek(kScans + 0.5)) << "behind the end";
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(3).back(), 3) << "goes on where it was";
  EXPECT_TRUE(seek(0.25)) << "before the beginning";
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(4).back(), 0);
  EXPECT_TRUE(is_paused());
}

TEST_P(PlayerServices, SeekBackFromTheEnd) {
  start(", start_s: 18, rate: 1000000");
  EXPECT_EQ(played(2), (std::vector<int>{18, 19}));
  EXPECT_TRUE(seek(18.0));
  EXPECT_EQ(played(5), (std::vector<int>{18, 19, 17, 18, 19}));
}

TEST_P(PlayerServices, SeekInTheMiddleOfPlaying) {
  start(", rate: 0.001");
  EXPECT_EQ(played(1), first(1));
  EXPECT_TRUE(seek(18.0));  // 17 minutes away
  EXPECT_EQ(played(2), (std::vector<int>{0, 17}));
  EXPECT_TRUE(seek(3.0));
  EXPECT_EQ(played(3), (std::vector<int>{0, 17, 2}));
  EXPECT_TRUE(seek(18.5));
  EXPECT_TRUE(set_rate(1e6));
  EXPECT_EQ(played(5), (std::vector<int>{0, 17, 2, 18, 19})) << "and nothing of before";
  EXPECT_FALSE(is_paused());
}

TEST_P(PlayerServices, SetTheRateAtOnce) {
  start(", rate: 0.001");
  EXPECT_EQ(played(1).size(), 1U);
  EXPECT_EQ(rate(), 0.001);
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(set_rate(wrong)) << wrong;
    EXPECT_EQ(rate(), 0.001);
  }
  EXPECT_TRUE(set_rate(1e6));  // would otherwise play for five hours
  EXPECT_EQ(played(kScans), first(kScans));
  EXPECT_EQ(rate(), 1e6);
}

TEST_P(PlayerServices, AgreeWithTheParameters) {
  start(", rate: 0.001, paused: true");
  EXPECT_TRUE(set_rate(0.002));
  EXPECT_EQ(parameter("rate").double_value(), 0.002);
  resume();
  EXPECT_FALSE(parameter("paused").bool_value());
  EXPECT_TRUE(set_parameter("paused", parameter_value(true)));
  EXPECT_TRUE(is_paused());
  EXPECT_FALSE(set_parameter("rate", parameter_value(0.0)));
  EXPECT_EQ(rate(), 0.002);
  EXPECT_TRUE(set_parameter("rate", parameter_value(1e6)));
  EXPECT_EQ(rate(), 1e6);
  EXPECT_TRUE(is_paused()) << "the rate is another, no more";
  EXPECT_TRUE(set_parameter("paused", parameter_value(false)));
  EXPECT_EQ(played(kScans), first(kScans));
}

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
INSTANTIATE_TEST_SUITE_P(All, PlayerServices, testing::Values("robot", "messages"));

}  // namespace
}  // namespace strata::player
