// SPDX-License-Identifier: Apache-2.0
/// What a broken or hostile node on the domain can send to each component, over UDP: every topic
/// and service that it reads is found out from the middleware, so that those of new components are
/// tested too.
/// STRATA_FUZZ_MESSAGES says how many each gets, STRATA_FUZZ_SEED which, and STRATA_FUZZ_TOPIC that
/// only names with this in them do.
///
/// The default takes 1 to 30 s of a core a component; a long one is STRATA_FUZZ_MESSAGES=200000.
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "components/bus/endpoint.hpp"
#include "components/bus/service.hpp"
#include "tests/across/every_component/bench.hpp"
#include "tests/across/every_component/fence.hpp"
#include "tests/across/every_component/good_messages.hpp"
#include "tests/across/every_component/mutator.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace strata::runtime {
namespace {

std::uint64_t number_from_environment(const char* name, std::uint64_t usual) {
  const char* text = std::getenv(name);
  return text == nullptr ? usual : std::strtoull(text, nullptr, 10);
}

/// Something that the component reads, as discovery tells it.
struct Target {
  std::string wire_topic;
  std::string type;
  bool transient_local = false;
  [[nodiscard]] bool is_service() const { return wire_topic.starts_with("rq/"); }
};

class LiveFuzz : public testing::TestWithParam<std::string> {
 protected:
  static constexpr int kBurst = 5;                    // as many as the smallest queue keeps
  static constexpr std::size_t kBurstBytes = 50'000;  // less than a socket holds
  static constexpr int kGoodSteps = 30;  // of a drive that shows that a component works

  static void SetUpTestSuite() {
    test::send_over_udp_within_the_process();
    // A sanitizer needs more room than there is.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    const rlimit limit{4ULL << 30U,
                       4ULL << 30U};  // what takes all memory is to end here, not the machine
    setrlimit(RLIMIT_AS, &limit);
#endif
  }

  LiveFuzz() : bench_(GetParam(), own_, folder_.path(), FeedMode::kLive) {
    bench_.component().configure();
    bench_.component().activate();
  }

  /// Everything that the component's participant reads; changing its state comes last.
  [[nodiscard]] std::vector<Target> targets() const {
    std::set<std::string> seen;
    std::vector<Target> found;
    for (const auto& endpoint : own_->view().endpoints) {
      if (endpoint.wire_topic.starts_with("rt/fence/")) continue;
      if (endpoint.writes || !bus::same_participant(endpoint.guid, own_->guid())) continue;
      if (!seen.insert(endpoint.wire_topic).second) continue;
      const char* only = std::getenv("STRATA_FUZZ_TOPIC");
      if (only != nullptr && endpoint.wire_topic.find(only) == std::string::npos) continue;
      found.push_back(
          {endpoint.wire_topic, bus::type_from_wire(endpoint.wire_type), endpoint.transient_local});
    }
    const auto rank = [](const Target& target) {
      return std::pair{target.is_service() + target.wire_topic.ends_with("change_stateRequest"),
                       target.wire_topic};
    };
    std::sort(found.begin(), found.end(),
              [&](const Target& a, const Target& b) { return rank(a) < rank(b); });
    return found;
  }

  /// A writer of another participant that the component's reader takes messages from.
  [[nodiscard]] std::unique_ptr<bus::RawWriter> writer_to(const Target& target) const {
    bus::QosProfile qos = bus::qos_profile("default");
    qos.transient_local = target.transient_local;
    auto writer = std::make_unique<bus::RawWriter>(other_, bus::TopicName::plain(target.wire_topic),
                                                   target.type, qos);
    EXPECT_TRUE(writer->wait_for_readers(1, std::chrono::seconds(20))) << target.wire_topic;
    return writer;
  }

  /// Waits until the component has got and worked on everything that was sent to it.
  void settle() {
    there_.pass();
    bench_.settle();
  }

  /// Whether each of its messages is counted, and none of its own is among them.
  [[nodiscard]] bool is_read_as_topic(const Target& target) {
    for (const auto& endpoint : own_->view().endpoints) {
      const bool is_own = bus::same_participant(endpoint.guid, own_->guid());
      if (endpoint.writes && is_own && endpoint.wire_topic == target.wire_topic) return false;
    }
    return std::any_of(
        bench_.component().topics().begin(), bench_.component().topics().end(),
        [&](const TopicUse& use) { return !use.writes && "rt" + use.topic == target.wire_topic; });
  }

  /// A reader may know its writer later than the writer knows it: until then nothing comes.
  void make_heard(bus::RawWriter& writer, const std::vector<std::uint8_t>& message) {
    const std::uint64_t before = bench_.component().counts().received;
    EXPECT_TRUE(test::comes_true([&] {
      writer.publish(message);
      settle();
      return bench_.component().counts().received > before;
    }));
  }

  void fuzz(const Target& target) {
    SCOPED_TRACE(target.wire_topic);
    const auto writer = writer_to(target);
    const std::uint64_t count = messages_;
    test::Mutator mutator(seed_ + std::hash<std::string>()(target.wire_topic));
    // Ten of each moment; after the last moment the clock is set back.
    std::vector<std::vector<std::uint8_t>> good;
    for (int step = 0; step < 100; ++step) {
      good.push_back(test::good_message(target.type, target.wire_topic, step));
    }
    const bool is_subscribed = is_read_as_topic(target);
    if (is_subscribed) make_heard(*writer, good.front());
    const MessageCounts before = bench_.component().counts();
    std::size_t under_way = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::vector<std::uint8_t> message = mutator.mutate(good[i / 10 % good.size()]);
      writer->publish(message);
      under_way += message.size();
      if (i % kBurst == kBurst - 1 || under_way > kBurstBytes) {
        settle();
        under_way = 0;
      }
      if (i % 100 == 99) bench_.tick();
    }
    bench_.tick();  // some take their messages then
    settle();
    const MessageCounts after = bench_.component().counts();
    EXPECT_EQ(after.received, after.done()) << "not every message is accounted for";
    if (is_subscribed) {
      EXPECT_EQ(after.received - before.received, count);
    }
    EXPECT_EQ(own_->caught().count(), 0U) << own_->caught().last();
  }

  /// Which of the component's topics carry something when a robot drives by, for as long as it
  /// takes until those that are expected do; some are published at most so often.
  [[nodiscard]] std::set<std::string> answers_to_a_drive(
      int first_step, const std::set<std::string>& expected = {}) {
    std::map<std::string, std::unique_ptr<bus::RawReader>> readers;
    std::mutex mutex;
    std::set<std::string> heard;
    std::vector<std::pair<const TopicUse*, std::unique_ptr<bus::RawWriter>>> writers;
    for (const TopicUse& use : bench_.component().topics()) {
      if (use.writes) {
        bus::QosProfile qos = use.qos;
        qos.transient_local = false;  // what comes now, not what was said before
        readers[use.topic] = std::make_unique<bus::RawReader>(
            other_, use.topic, use.type, qos, [&, topic = use.topic](const bus::RawMessage&) {
              const std::lock_guard lock(mutex);
              heard.insert(topic);
            });
        EXPECT_TRUE(readers[use.topic]->wait_for_writers(1, std::chrono::seconds(20)));
      } else {
        writers.emplace_back(&use,
                             writer_to({"rt" + use.topic, use.type, use.qos.transient_local}));
      }
    }
    int step = first_step;
    const auto drive_on = [&] {
      for (int last = step + kGoodSteps; step < last; ++step) {
        for (const auto& [use, writer] : writers) {
          writer->publish(test::good_message(use->type, use->topic, step));
          settle();
        }
        bench_.tick();
      }
      back_.pass();  // behind what the component says
      const std::lock_guard lock(mutex);
      return std::includes(heard.begin(), heard.end(), expected.begin(), expected.end());
    };
    (void)test::comes_true(drive_on);
    const std::lock_guard lock(mutex);
    return heard;
  }

  /// What the component says of itself on /diagnostics, for who has to find out what is wrong.
  [[nodiscard]] std::string status() {
    std::mutex mutex;
    std::string text;
    const bus::Reader<diagnostic_msgs::msg::DiagnosticArray> reader(
        other_, "/diagnostics", bus::qos_profile("default"), [&](const auto& message) {
          const std::lock_guard lock(mutex);
          for (const auto& entry : message.status().at(0).values()) {
            text += "  " + entry.key() + ": " + entry.value() + "\n";
          }
        });
    (void)test::comes_true([&] {
      bench_.tick();
      const std::lock_guard lock(mutex);
      return !text.empty();
    });
    return text;
  }

  test::TemporaryDirectory folder_;
  std::uint64_t messages_ = number_from_environment("STRATA_FUZZ_MESSAGES", 10'000);
  std::uint64_t seed_ = number_from_environment("STRATA_FUZZ_SEED", 1);
  std::shared_ptr<bus::Participant> own_ = test::make_participant();
  std::shared_ptr<bus::Participant> other_ = test::make_participant();
  test::Fence there_{other_, own_, "/fence/there"};
  test::Fence back_{own_, other_, "/fence/back"};
  test::Bench bench_;
};

TEST_P(LiveFuzz, EndsNothingAndEverythingIsCountedAndGoodMessagesStillWork) {
  std::set<std::string> usual = answers_to_a_drive(0);
  for (int more = 1; more < 5; ++more) usual.merge(answers_to_a_drive(more * kGoodSteps));
  usual.erase("/tf_static");  // said at the beginning only
  RecordProperty("answers", testing::PrintToString(usual));
  if (GetParam() == "strata::ScanMatcher" || GetParam() == "strata::Localizer") {
    ASSERT_FALSE(usual.empty());
  }
  const std::vector<Target> all = targets();
  ASSERT_FALSE(all.empty());
  bool is_driven = false;
  for (const Target& target : all) {
    if (target.is_service() && !is_driven) {
      // Much later than anything that a mutated stamp is likely to have said.
      EXPECT_THAT(answers_to_a_drive(100'000, usual), testing::IsSupersetOf(usual)) << status();
      is_driven = true;
    }
    fuzz(target);
  }
  if (!is_driven) {
    EXPECT_THAT(answers_to_a_drive(100'000, usual), testing::IsSupersetOf(usual)) << status();
  }
  // A second of bad messages must not fill a log.
  const std::vector<std::string> errors = bench_.take_errors();
  EXPECT_LT(errors.size(), 500U);
  EXPECT_THAT(errors, testing::Each(testing::Not(testing::HasSubstr("bad_alloc"))));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 2'000'000) << "kB";
  bench_.component().shutdown();
  EXPECT_EQ(bench_.component().state(), LifecycleState::kFinalized);
}

INSTANTIATE_TEST_SUITE_P(All, LiveFuzz, testing::ValuesIn(test::component_types()),
                         [](const auto& test) { return test.param.substr(8); });

}  // namespace
}  // namespace strata::runtime
