// SPDX-License-Identifier: Apache-2.0
/// A patch learner one of whose files is damaged goes on with the other.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/map_messages.hpp"
#include "components/log/state_store.hpp"
#include "components/patch_learner/learner_store.hpp"
#include "components/patch_learner/register.hpp"
#include "core/grid/counting_map.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::patch_learner {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kInState = 20;
constexpr std::size_t kAfterIt = 15;

class DamagedLearnerStore : public ::testing::Test {
 protected:
  /// What a life leaves that ends some scans after a state was written.
  DamagedLearnerStore() {
    RandomStream random(3, StreamId::kTest);
    std::vector<PosedScan> scans;
    patch::test_world::ToyRobot{}.drive(patch::test_world::corridor_with_door(true),
                                        {1.0, 1.2, 0.0}, {10.0, 1.2, 0.0}, 4, 100.0, {}, random,
                                        scans);
    CountingMap counts(0.05);
    for (const PosedScan& scan : scans) counts.add(scan);
    base_ = counts.reflection();
    patch::OnlinePatchLearner learner({}, {}, base_);
    for (std::size_t i = 0; i < kInState; ++i) (void)learner.add(scans[i]);
    LearnerStore store(folder(), 1e6);
    store.begin(learner);
    for (std::size_t i = kInState; i < kInState + kAfterIt; ++i) {
      (void)learner.add(scans[i]);
      store.add(learner, scans[i]);
    }
    store.flush();
    register_component(registry_);
  }
  [[nodiscard]] fs::path folder() const { return folder_.path() / "learned"; }
  [[nodiscard]] fs::path state() const { return folder() / "learner.state"; }
  [[nodiscard]] fs::path scans() const {
    return folder() / ("scans_" + std::to_string(kInState) + ".db");
  }

  /// How many scans a life knows that begins now, and what it says.
  struct Begun {
    std::string scans;
    std::string without_map;  ///< empty: it has begun to learn
    std::vector<std::string> errors;
  };
  [[nodiscard]] Begun begin(const ReflectionGrid& base) {
    const auto participant = test::make_participant();
    bus::Writer<strata_msgs::msg::ReflectionGrid> maps(participant, "/reflection_filtered",
                                                       bus::qos_profile("latched"));
    maps.publish(convert::to_message(base));
    test::StatusWatch watch(participant);
    const auto host = test::make_host(
        "{type: strata::PatchLearner, name: learner, parameters: {online: {enabled: true, store: "
        "{folder: '" +
            folder().string() + "'}}}}",
        registry_, test::make_participant());
    host->activate();
    const auto status = watch.wait_for(*host, [](const auto& now) {
      return test::value_of(now, "processed") == "1" || test::value_of(now, "skipped") == "1";
    });
    return {test::value_of(status, "scans"), test::value_of(status, "scans without a map"),
            host->take_errors()};
  }
  [[nodiscard]] Begun begin() { return begin(base_); }

 private:
  test::TemporaryDirectory folder_;
  ReflectionGrid base_;
  runtime::Registry registry_;
};

TEST_F(DamagedLearnerStore, ThatIsWholeIsGoneOnFrom) {
  const Begun begun = begin();
  EXPECT_EQ(begun.scans, std::to_string(kInState + kAfterIt));
  EXPECT_THAT(begun.errors, IsEmpty());
}

TEST_F(DamagedLearnerStore, KeepsTheScansAfterTheStateWhenThatIsLost) {
  const std::string bytes = test::bytes_of(state()).substr(0, 1000);
  std::ofstream(state(), std::ios::binary | std::ios::trunc) << bytes;
  const Begun begun = begin();
  EXPECT_EQ(begun.scans, std::to_string(kAfterIt));
  const std::string aside = state().string() + ".damaged";
  EXPECT_THAT(begun.errors, ElementsAre(HasSubstr(aside)));
  EXPECT_EQ(test::bytes_of(aside), bytes);
  const Begun next = begin();
  EXPECT_EQ(next.scans, std::to_string(kAfterIt));
  EXPECT_THAT(next.errors, IsEmpty());
  EXPECT_EQ(test::bytes_of(aside), bytes);
}

TEST_F(DamagedLearnerStore, KeepsTheStateWhenTheScansAfterItAreLost) {
  for (const std::string& bytes : {test::bytes_of(scans()).substr(0, 5000), std::string()}) {
    std::ofstream(scans(), std::ios::binary | std::ios::trunc) << bytes;
    const Begun begun = begin();
    EXPECT_EQ(begun.scans, std::to_string(kInState));
    const std::string aside = scans().string() + (bytes.empty() ? ".damaged-2" : ".damaged");
    EXPECT_THAT(begun.errors, ElementsAre(HasSubstr(aside)));
    EXPECT_EQ(test::bytes_of(aside), bytes);
  }
  EXPECT_EQ(test::bytes_of(scans().string() + ".damaged").size(), 5000U)
      << "cleared away with old scans";
}

TEST_F(DamagedLearnerStore, BeginsAnewWhenBothAreLost) {
  fs::resize_file(state(), 0);
  fs::resize_file(scans(), 5000);
  const Begun begun = begin();
  EXPECT_EQ(begun.scans, "0");
  EXPECT_THAT(begun.errors, ElementsAre(HasSubstr("learner.state.damaged"),
                                        HasSubstr(scans().string() + ".damaged")));
}

TEST_F(DamagedLearnerStore, OfAnotherResolutionIsRefusedAndLeftAlone) {
  const std::string before = test::bytes_of(state());
  const Begun begun = begin(make_reflection_grid(0.1, CellRect{{0, 0}, {4, 4}}));
  EXPECT_THAT(begun.errors, ElementsAre(HasSubstr("of another resolution")));
  EXPECT_EQ(begun.without_map, "0") << "nothing is learned on half of it";
  EXPECT_EQ(test::bytes_of(state()), before);
}

}  // namespace
}  // namespace strata::patch_learner
