// SPDX-License-Identifier: Apache-2.0
/// A component whose middleware refuses one endpoint: it is made whole or not at all, says why, and
/// can be asked again.
#include <functional>
#include <memory>
#include <new>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/across/every_component/bench.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"

namespace strata::runtime {
namespace {

using ::testing::HasSubstr;

struct Refusal {
  const char* name;
  std::function<void(const std::string& topic)> refuse;  ///< throws
};

class HalfMade : public testing::TestWithParam<std::tuple<std::string, FeedMode>> {
 protected:
  [[nodiscard]] std::unique_ptr<test::Bench> bench() const {
    return std::make_unique<test::Bench>(std::get<0>(GetParam()), participant_, folder_.path(),
                                         std::get<1>(GetParam()));
  }
  /// Lets the first `count` endpoints be made and refuses the next.
  void refuse_after(int count, const std::function<void(const std::string&)>& refuse) {
    made_ = 0;
    participant_->set_before_endpoint([this, count, refuse](const std::string& topic) {
      if (made_++ == count) refuse(topic);
    });
  }
  void allow_all() {
    made_ = 0;
    participant_->set_before_endpoint([this](const std::string& /*topic*/) { ++made_; });
  }
  [[nodiscard]] std::multiset<std::string> endpoints() const {
    std::multiset<std::string> topics;
    for (const auto& endpoint : participant_->view().endpoints) topics.insert(endpoint.wire_topic);
    return topics;
  }
  /// How many endpoints it makes until it is inactive.
  int count_endpoints() {
    allow_all();
    const auto bench = this->bench();
    bench->component().configure();
    topics_ = bench->component().topics().size();
    return made_;
  }
  /// Refuses each endpoint once. retry: whether the same component is asked again, or ends so.
  void refuse_each(const std::function<void(const std::string&)>& refuse, const std::string& reason,
                   bool retry) {
    const int count = count_endpoints();
    ASSERT_GT(count, 1);
    const auto before = endpoints();
    for (int k = 0; k < count; ++k) {
      SCOPED_TRACE("endpoint " + std::to_string(k) + " of " + std::to_string(count));
      const auto bench = this->bench();
      Component& component = bench->component();
      refuse_after(k, refuse);
      try {
        component.configure();
        FAIL() << "configured without an endpoint";
      } catch (const std::exception& error) {
        EXPECT_THAT(error.what(), HasSubstr(reason));
      }
      EXPECT_EQ(component.state(), LifecycleState::kUnconfigured);
      EXPECT_TRUE(component.topics().empty());
      bench->tick();  // says which endpoints it has
      if (retry) {
        allow_all();
        component.configure();
        EXPECT_EQ(component.state(), LifecycleState::kInactive);
        EXPECT_EQ(component.topics().size(), topics_);
        if (std::get<1>(GetParam()) == FeedMode::kLive) component.activate();
        bench->tick();
      }
      component.shutdown();
      EXPECT_EQ(component.state(), LifecycleState::kFinalized);
      EXPECT_EQ(endpoints(), before);
      EXPECT_THAT(bench->take_errors(), testing::IsEmpty());
    }
  }

  test::TemporaryDirectory folder_;
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  int made_ = 0;
  std::size_t topics_ = 0;  // of one that is configured
};

TEST_P(HalfMade, IsConfiguredWhenItIsAskedAgainAfterTheCauseIsGone) {
  refuse_each([](const std::string& topic) { throw OutputError(topic, "is refused", "allow it"); },
              "is refused; allow it", true);
}

TEST_P(HalfMade, EndsCleanlyWhereMemoryRanOut) {
  refuse_each([](const std::string& /*topic*/) { throw std::bad_alloc(); }, "bad_alloc", false);
}

INSTANTIATE_TEST_SUITE_P(Live, HalfMade,
                         testing::Combine(testing::ValuesIn(test::component_types()),
                                          testing::Values(FeedMode::kLive)),
                         [](const auto& test) { return std::get<0>(test.param).substr(8); });
INSTANTIATE_TEST_SUITE_P(Lockstep, HalfMade,
                         testing::Combine(testing::ValuesIn(test::component_types()),
                                          testing::Values(FeedMode::kLockstep)),
                         [](const auto& test) { return std::get<0>(test.param).substr(8); });

}  // namespace
}  // namespace strata::runtime
