// SPDX-License-Identifier: Apache-2.0
/// What every component does by itself: its life, its messages and its status on /diagnostics.
#include "components/runtime/component.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"

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
  EXPECT_EQ(value_of(status, "colour"), "green");
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
