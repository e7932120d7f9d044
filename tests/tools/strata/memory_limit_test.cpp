// SPDX-License-Identifier: Apache-2.0
/// A process that may have little address space (`ulimit -v`): it runs, or says on one line why
/// not.
#include <algorithm>
#include <filesystem>
#include <new>
#include <regex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/replay_fixture.hpp"
#include "tools/strata/memory_advice.hpp"
#include "tools/strata/shortage.hpp"

namespace strata::tools {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// What became of a robot that maps.
struct Life {
  bool has_run = false;
  int code = -1;
  std::string said;
};

Life live_within(int kilobytes) {
  test::ChildProcess robot({"bash", "-c",
                            "ulimit -c 0; ulimit -v " + std::to_string(kilobytes) +
                                "; exec '" STRATA_PROGRAM "' run '" STRATA_SOURCE_DIR
                                "/components/config/mapping.yaml' --set domain=" +
                                std::to_string(test::own_domain())},
                           {}, test::ChildProcess::Errors::kMerged);
  Life life;
  std::string first = robot.wait_for_line("", std::chrono::seconds(60));
  life.has_run = first.starts_with("process mapping runs");
  if (life.has_run) robot.send(SIGINT);
  life.said = first + "\n" + robot.rest();
  life.code = robot.wait();
  return life;
}

// A sanitizer needs more room than there is.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(MemoryLimit, LetsARobotRunOrItSaysOnOneLineWhyNot) {
  for (const int kilobytes :
       {110'000, 130'000, 150'000, 170'000, 190'000, 210'000, 220'000, 230'000, 240'000, 260'000}) {
    SCOPED_TRACE(kilobytes);
    const Life life = live_within(kilobytes);
    EXPECT_EQ(std::count(life.said.begin(), life.said.end(), '\n'), 1) << life.said;
    if (life.has_run) {
      EXPECT_EQ(life.code, 0) << life.said;
    } else {
      EXPECT_EQ(life.code, 1) << life.said;
      EXPECT_THAT(life.said, HasSubstr("strata run: error: limits of this process"));
      EXPECT_THAT(life.said, HasSubstr("ulimit -v"));
    }
  }
}

// Threads that each reserve 64 MB for themselves would use it up at once.
TEST(MemoryLimit, Of300MegabytesIsEnoughForARobotThatHolds40) {
  for (const int kilobytes : {300'000, 400'000, 600'000, 1'000'000, 3'000'000}) {
    SCOPED_TRACE(kilobytes);
    const Life life = live_within(kilobytes);
    EXPECT_TRUE(life.has_run) << life.said;
    EXPECT_EQ(life.code, 0) << life.said;
  }
}
#endif

TEST(Shortage, SaysWhatNeededHowMuchAndWhichSettingMakesItLess) {
  note_failed_allocation(123'400'000);
  const std::string learn = describe_shortage(std::bad_alloc(), {"learn", "match scans"});
  EXPECT_THAT(learn, HasSubstr("'match scans' needed 123 MB more, beside "));
  EXPECT_THAT(learn, HasSubstr("slam.beam_filter.resolution_m=0.1"));
  EXPECT_THAT(describe_shortage(std::bad_alloc(), {"learn", "remember scans"}),
              HasSubstr("--only em,patch"));
  EXPECT_THAT(describe_shortage(std::bad_alloc(), {"localize", "localize"}),
              HasSubstr("localizer.particles=N"));
}

TEST(Shortage, OfAComponentIsPutIntoWords) {
  note_failed_allocation(64'000'000);
  const std::string told =
      shortage_in_words("/a/filter: std::bad_alloc", "strata::BeamFilter", "filter");
  EXPECT_THAT(told, testing::StartsWith("/a/filter: memory ran out: it needed 64 MB more, "));
  EXPECT_THAT(told, HasSubstr("--set filter.filter.resolution_m=0.1; or"));
  const auto of_another = [](const std::string& text) {
    return shortage_in_words(text, "example::Alarm", "a");
  };
  EXPECT_THAT(of_another("/a: std::bad_alloc"), HasSubstr("fewer components, or more memory"));
  EXPECT_THAT(of_another("/a: Resource temporarily unavailable"), HasSubstr("ulimit -u"));
  EXPECT_EQ(of_another("/a: the disk is full"), "/a: the disk is full");
}

/// The keys that an advice tells to set, without the component's name.
std::vector<std::string> keys_in(const std::string& advice, const std::string& before) {
  const std::regex set("--set " + before + "([a-z_.]+)=");
  std::vector<std::string> keys;
  for (auto it = std::sregex_iterator(advice.begin(), advice.end(), set);
       it != std::sregex_iterator(); ++it) {
    keys.push_back((*it)[1]);
  }
  return keys;
}

TEST(Shortage, TellsOfSettingsThatEachComponentHas) {
  const std::pair<const char*, const char*> pages[] = {
      {"strata::ScanMatcher", "scan_matcher"},
      {"strata::BeamFilter", "beam_filter"},
      {"strata::PatchLearner", "patch_learner"},
      {"strata::Localizer", "localizer"},
      {"strata::TimescaleMemory", "timescale_memory"},
      {"strata::TopologyMapper", "topology_mapper"},
      {"strata::VolumeMapper", "volume_mapper"},
      {"strata::IncidentRecorder", "incident_recorder"}};
  for (const auto& [type, page] : pages) {
    SCOPED_TRACE(type);
    const auto keys = keys_in(memory_advice_of_component(type, "mine"), "mine\\.");
    EXPECT_THAT(keys, testing::Not(IsEmpty()));
    const std::string text =
        test::bytes_of(std::filesystem::path(STRATA_SOURCE_DIR) / "docs/reference" /
                       ("component_" + std::string(page) + ".md"));
    for (const std::string& key : keys) EXPECT_THAT(text, HasSubstr("| `" + key + "` |"));
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
class ShortageOfAVerb : public test::ReplayFixture {};

TEST_F(ShortageOfAVerb, IsToldWithWhatWasAskedForAndWhatMakesItLess) {
  const auto outcome = test::run_strata_under(
      "ulimit -c 0; ulimit -v 400000;",
      "localize " + test::quoted(log()) + " --model filtered --initial-pose 0,0,0 --maps " +
          test::quoted(at("direct")) + " --set localizer.particles=20000000 --out " +
          test::quoted(at("out")) + " 2>&1");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, testing::StartsWith("strata localize: error: memory: ran out under the "
                                               "limit of 390 MB on address space"));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("needed [0-9]+ MB more, beside [0-9.]+ MB"));
  EXPECT_THAT(outcome.out, HasSubstr("--set localizer.particles=N"));
}
#endif

TEST(Shortage, OfMemoryAndOfThreadsSaysWhatToDo) {
  EXPECT_THAT(describe_shortage(std::bad_alloc()), HasSubstr("memory: ran out"));
  const std::system_error no_thread(
      std::make_error_code(std::errc::resource_unavailable_try_again));
  EXPECT_THAT(describe_shortage(no_thread), HasSubstr("ulimit -u"));
  EXPECT_THAT(describe_shortage(std::runtime_error("other")), IsEmpty());
}

}  // namespace
}  // namespace strata::tools
