// SPDX-License-Identifier: Apache-2.0
/// What every component does by itself: its life, its messages and its status on /diagnostics.
#include "components/runtime/component.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "core/base/error.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::runtime {
namespace {

using diagnostic_msgs::msg::DiagnosticStatus;
using sensor_msgs::msg::LaserScan;
using test::value_of;
using ::testing::HasSubstr;

/// Sends what comes on `in` to `out`; a scan of the frame "bad" is an error.
class Echo final : public Component {
 public:
  using Component::Component;

 private:
  void on_configure() override {
    publish_ = advertise<LaserScan>("out", "latched");
    subscribe<LaserScan>("in", "latched", [this](const LaserScan& scan) {
      if (scan.header().frame_id() == "bad") throw InputError("in", "bad scan", "send another");
      publish_(scan);
    });
  }
  void on_diagnose(Health& health) const override { health.add("colour", std::string("green")); }
  std::function<void(const LaserScan&)> publish_;
};

Registry echo_registry() {
  Registry registry;
  registry.add<Echo>("strata::Echo");
  return registry;
}

LaserScan scan_of(const std::string& frame) {
  LaserScan scan;
  scan.header().frame_id(frame);
  return scan;
}

struct Bench {
  std::shared_ptr<bus::Participant> participant = test::make_participant();
  test::StatusWatch watch{participant};
  bus::Writer<LaserScan> writer{participant, "/in", bus::qos_profile("latched")};
  std::unique_ptr<Host> host =
      test::make_host("{type: strata::Echo, name: echo}", echo_registry(), participant);
};

TEST(Component, KeepsALatchedMessageThatComesBeforeItIsActive) {
  Bench bench;
  bench.writer.publish(scan_of("early"));
  // The message is here, the component is not yet at work.
  const DiagnosticStatus before = bench.watch.wait_for(
      *bench.host, [](const auto& status) { return value_of(status, "received /in") == "1"; });
  ASSERT_EQ(value_of(before, "state"), "inactive");
  ASSERT_EQ(value_of(before, "processed"), "0");
  bench.host->activate();
  test::Collector<LaserScan> out(bench.participant, "/out", "latched");
  EXPECT_THAT(out.wait_for(1), testing::ElementsAre(scan_of("early")));
}

TEST(Component, GivesALateParticipantItsLatchedMessage) {
  Bench bench;
  bench.host->activate();
  bench.writer.publish(scan_of("only"));
  (void)bench.watch.wait_for(
      *bench.host, [](const auto& status) { return value_of(status, "published /out") == "1"; });
  test::Collector<LaserScan> late(test::make_participant(), "/out", "latched");
  EXPECT_THAT(late.wait_for(1), testing::ElementsAre(scan_of("only")));
}

TEST(Component, TellsItsStateItsCountsAndWhatItAddsOnDiagnostics) {
  Bench bench;
  bench.host->activate();
  bench.writer.publish(scan_of("good"));
  const DiagnosticStatus status = bench.watch.wait_for(
      *bench.host, [](const auto& s) { return value_of(s, "processed") == "1"; });
  EXPECT_EQ(status.name(), "echo: health");
  EXPECT_EQ(status.level(), 0);
  EXPECT_EQ(status.message(), "OK");
  EXPECT_EQ(value_of(status, "state"), "active");
  EXPECT_EQ(value_of(status, "skipped"), "0");
  EXPECT_EQ(value_of(status, "published /out"), "1");
  EXPECT_EQ(value_of(status, "lost /in"), "0");
  EXPECT_THAT(value_of(status, "work times /in"), HasSubstr(" inf:1 sum:"));
  EXPECT_GT(std::stoull(value_of(status, "process_memory_bytes")), 1'000'000U);
  EXPECT_EQ(value_of(status, "colour"), "green");
}

/// Keeps the frames of scans, which it takes at ticks.
class Patient final : public Component {
 public:
  using Component::Component;
  /// Of whoever wants to know it after the component's end, too.
  std::shared_ptr<std::vector<std::string>> frames = std::make_shared<std::vector<std::string>>();

 private:
  void on_configure() override {
    subscribe_raw(
        resolve("in"), bus::MessageType<LaserScan>::name, bus::qos_profile("lossless"),
        [this](const bus::RawMessage& message) {
          frames->push_back(convert::from_cdr<LaserScan>(message.cdr, "/in").header().frame_id());
        },
        {.at_ticks = true});
  }
};

TEST(Component, TakesAtATickWhatCameSinceTheLastWhereThatIsEnough) {
  const auto participant = test::make_participant();
  bus::Writer<LaserScan> writer(participant, "/in", bus::qos_profile("lossless"));
  Registry registry;
  registry.add<Patient>("strata::Patient");
  const auto host =
      test::make_host("{type: strata::Patient, name: patient}", registry, participant);
  host->activate();
  ASSERT_TRUE(writer.raw().wait_for_readers(1, std::chrono::seconds(20)));
  const auto& patient = dynamic_cast<const Patient&>(*host->components().front());
  const auto frames = patient.frames;
  for (const char* frame : {"a", "b", "c"}) writer.publish(scan_of(frame));
  ASSERT_TRUE(test::comes_true([&] { return patient.counts().received == 3; }));
  EXPECT_EQ(patient.counts().processed, 0U);
  host->tick();
  ASSERT_TRUE(test::comes_true([&] { return patient.counts().processed == 3; }));
  EXPECT_THAT(*frames, testing::ElementsAre("a", "b", "c"));
  writer.publish(scan_of("last"));
  ASSERT_TRUE(test::comes_true([&] { return patient.counts().received == 4; }));
  host->stop();
  EXPECT_THAT(*frames, testing::ElementsAre("a", "b", "c", "last")) << "at the end too";
}

/// Throws what its scan's frame says.
class Throwing final : public Component {
 public:
  using Component::Component;

 private:
  void on_configure() override {
    subscribe<LaserScan>("in", "latched", [](const LaserScan& scan) {
      const std::string& what = scan.header().frame_id();
      if (what == "bad_alloc") throw std::bad_alloc();
      if (what == "out_of_range") throw std::out_of_range("beyond");
      if (what == "yaml") throw YAML::Exception(YAML::Mark(), "no yaml");
      if (what == "int") throw 7;  // NOLINT: whatever others throw
    });
  }
};

TEST(Component, GoesOnWhateverACallbackThrows) {
  Bench bench;
  Registry registry;
  registry.add<Throwing>("test::Throwing");
  bench.host =
      test::make_host("{type: test::Throwing, name: throwing}", registry, bench.participant);
  bench.host->activate();
  const Component& component = *bench.host->components().front();
  std::uint64_t sent = 0;
  for (const char* what : {"bad_alloc", "out_of_range", "yaml", "int", "none"}) {
    bench.writer.publish(scan_of(what));
    ++sent;
    ASSERT_TRUE(test::comes_true([&] { return component.counts().done() == sent; })) << what;
  }
  EXPECT_EQ(component.counts().skipped, 4U);
  EXPECT_EQ(component.counts().processed, 1U);
  EXPECT_THAT(bench.host->take_errors(),
              testing::ElementsAre(HasSubstr("bad_alloc"), HasSubstr("beyond"),
                                   HasSubstr("no yaml"), HasSubstr("unknown type")));
}

TEST(Component, CountsBytesThatAreNoMessage) {
  Bench bench;
  bench.host->activate();
  const Component& component = *bench.host->components().front();
  bench.writer.raw().publish({0, 1, 0, 0, 9});
  ASSERT_TRUE(test::comes_true([&] { return component.counts().skipped == 1; }));
  bench.writer.raw().publish({0, 3, 0, 0});  // a parameter list
  ASSERT_TRUE(test::comes_true([&] { return component.counts().skipped == 2; }));
  const DiagnosticStatus status = bench.watch.wait_for(
      *bench.host, [](const auto& s) { return value_of(s, "undecodable") == "2"; });
  EXPECT_EQ(value_of(status, "skipped"), "2");
  EXPECT_EQ(value_of(status, "received /in"), "2");
}

TEST(Component, TellsAFloodOfBadMessagesOnce) {
  Bench bench;
  bench.host->activate();
  const Component& component = *bench.host->components().front();
  for (std::uint64_t sent = 1; sent <= 1000; ++sent) {
    bench.writer.publish(scan_of("bad"));
    ASSERT_TRUE(test::comes_true([&] { return component.counts().done() == sent; }));
  }
  EXPECT_EQ(component.counts().skipped, 1000U);
  EXPECT_EQ(bench.host->take_errors().size(), 1U);
}

TEST(Component, SaysWhyItCannotBeConfiguredAndLives) {
  const auto participant = test::make_participant();
  // The middleware allows one type a topic.
  const bus::Writer<rosgraph_msgs::msg::Clock> other(participant, "/in",
                                                     bus::qos_profile("latched"));
  try {
    (void)test::make_host("{type: strata::Echo, name: echo}", echo_registry(), participant);
    FAIL() << "subscribed to a topic of another type";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/in: carries rosgraph_msgs/msg/Clock"));
  }
  const auto host = test::make_host("{type: strata::Echo, name: echo, remappings: {in: other}}",
                                    echo_registry(), participant);
  host->activate();
  EXPECT_EQ(host->components().front()->state(), LifecycleState::kActive);
}

TEST(Component, ReportsAnErrorAtOnceAndRecovers) {
  Bench bench;
  bench.host->activate();
  bench.writer.publish(scan_of("bad"));
  const DiagnosticStatus broken =
      bench.watch.wait_for(*bench.host, [](const auto& s) { return s.level() == 2; });
  EXPECT_THAT(broken.message(), HasSubstr("bad scan"));
  EXPECT_EQ(value_of(broken, "skipped"), "1");
  EXPECT_EQ(bench.host->take_errors().size(), 1U);
  const DiagnosticStatus well =
      bench.watch.wait_for(*bench.host, [](const auto& s) { return s.level() == 0; });
  EXPECT_THAT(value_of(well, "last_error"), HasSubstr("bad scan"));
}

}  // namespace
}  // namespace strata::runtime
