// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/executor.hpp"

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "components/runtime/host.hpp"
#include "components/settings/yaml_document.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata::runtime {
namespace {

using sensor_msgs::msg::LaserScan;

/// What two components share: the first blocks in its callback until it is let go.
struct Meeting {
  std::promise<void> first_begins;
  std::promise<void> go;
  std::shared_future<void> let_go = go.get_future().share();
  std::promise<void> second_is_served;
  std::atomic<bool> first_is_over = false;
  std::atomic<bool> second_found_it_over = false;
  std::thread::id first_thread;
  std::thread::id second_thread;
};

class First final : public Component {
 public:
  First(ComponentContext context, Meeting& meeting)
      : Component(std::move(context)), meeting_(meeting) {}

 private:
  void on_configure() override {
    subscribe<LaserScan>("first", "latched", [this](const LaserScan&) {
      meeting_.first_thread = std::this_thread::get_id();
      meeting_.first_begins.set_value();
      meeting_.let_go.wait();
      meeting_.first_is_over = true;
    });
  }
  Meeting& meeting_;
};

class Second final : public Component {
 public:
  Second(ComponentContext context, Meeting& meeting)
      : Component(std::move(context)), meeting_(meeting) {}

 private:
  void on_configure() override {
    subscribe<LaserScan>("second", "latched", [this](const LaserScan&) {
      meeting_.second_thread = std::this_thread::get_id();
      meeting_.second_found_it_over = meeting_.first_is_over.load();
      meeting_.second_is_served.set_value();
    });
  }
  Meeting& meeting_;
};

/// Both in one process, and a robot that has published for the second while the first blocks.
class ExecutorOf : public testing::Test {
 protected:
  void start(const std::string& executor) {
    Registry registry;
    registry.add("test::First", [this](ComponentContext context) {
      return std::make_unique<First>(std::move(context), meeting_);
    });
    registry.add("test::Second", [this](ComponentContext context) {
      return std::make_unique<Second>(std::move(context), meeting_);
    });
    const auto composition = read_composition(
        settings::parse_yaml("processes: [{name: p, executor: " + executor +
                                 ", components: [{type: test::First, name: first}, "
                                 "{type: test::Second, name: second}]}]",
                             "test.yaml"),
        "test.yaml");
    host_ = std::make_unique<Host>(composition, composition.processes[0], registry, participant_,
                                   HostOptions{});
    host_->activate();
    first_.publish({});
    ASSERT_EQ(meeting_.first_begins.get_future().wait_for(kPatience), std::future_status::ready);
    second_.publish({});
  }
  [[nodiscard]] bool second_is_served() {
    return served_.wait_for(kPatience) == std::future_status::ready;
  }

  static constexpr auto kPatience = std::chrono::seconds(20);
  Meeting meeting_;
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  bus::Writer<LaserScan> first_{participant_, "/first", bus::qos_profile("latched")};
  bus::Writer<LaserScan> second_{participant_, "/second", bus::qos_profile("latched")};
  std::future<void> served_ = meeting_.second_is_served.get_future();
  std::unique_ptr<Host> host_;
};

TEST_F(ExecutorOf, SeveralThreadsServesOneComponentWhileAnotherWorks) {
  start("multi_threaded");
  EXPECT_TRUE(second_is_served());  // nobody has let the first one go
  meeting_.go.set_value();
  host_->stop();
  EXPECT_FALSE(meeting_.second_found_it_over);
  EXPECT_NE(meeting_.first_thread, meeting_.second_thread);
}

TEST_F(ExecutorOf, OneThreadServesOneComponentAfterTheOther) {
  start("single_threaded");
  meeting_.go.set_value();
  EXPECT_TRUE(second_is_served());
  host_->stop();
  EXPECT_TRUE(meeting_.second_found_it_over);
  EXPECT_EQ(meeting_.first_thread, meeting_.second_thread);
}

TEST(Mailbox, GoesOnAfterATaskThatThrowsAndCountsIt) {
  Mailbox mailbox;
  mailbox.post([] { throw std::length_error("too long"); });
  mailbox.post([] { throw 7; });  // NOLINT: whatever others throw
  bool is_done = false;
  mailbox.call([&] { is_done = true; });
  EXPECT_TRUE(is_done);
  EXPECT_EQ(mailbox.caught().count(), 2U);
  EXPECT_EQ(mailbox.caught().last(), "an exception of unknown type");
}

TEST(Mailbox, DoesItsTasksOneByOneInTheOrderOfPosting) {
  Executor executor(ExecutorKind::kSingleThreaded);
  const auto first = executor.mailbox();
  const auto second = executor.mailbox();
  std::vector<int> done;
  for (int i = 0; i < 100; ++i) {
    (i % 2 == 0 ? first : second)->post([&done, i] { done.push_back(i); });
  }
  first->call([] {});
  ASSERT_EQ(done.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
}

}  // namespace
}  // namespace strata::runtime
