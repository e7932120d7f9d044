// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/unreadable_topics.hpp"

#include <new>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class UnreadableTopicsTest : public testing::Test {
 protected:
  static bus::PublishedTopic of(const std::string& type) { return {type, true, false}; }
  bool refuse(const std::string& topic, const std::string& type = "a/msg/B") {
    return topics_.read(topic, of(type), [&] {
      ++tried_;
      throw OutputError(topic, "may not be read", "allow it");
    });
  }
  [[nodiscard]] Health health() const {
    Health health;
    topics_.tell(health);
    return health;
  }
  std::vector<std::string> told_;
  UnreadableTopics topics_{[this](const std::string& line) { told_.push_back(line); }};
  int tried_ = 0;
};

TEST_F(UnreadableTopicsTest, AreToldOnceAndNotTriedAgainAsTheyAre) {
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(refuse("/odd"));
  EXPECT_EQ(tried_, 1);
  EXPECT_THAT(told_, ElementsAre("cannot read /odd: may not be read; allow it"));
  EXPECT_EQ(health().level(), HealthLevel::kWarn);
  EXPECT_THAT(health().message(), HasSubstr("/odd: may not be read"));
}

TEST_F(UnreadableTopicsTest, AreTriedAgainWithAnotherTypeAndThenRead) {
  EXPECT_FALSE(refuse("/odd"));
  EXPECT_FALSE(refuse("/odd", "a/msg/C"));
  EXPECT_EQ(tried_, 2);
  EXPECT_TRUE(topics_.read("/odd", of("a/msg/D"), [] {}));
  EXPECT_EQ(health().level(), HealthLevel::kOk);
}

TEST_F(UnreadableTopicsTest, AreForgottenWhenNobodyPublishesThem) {
  EXPECT_FALSE(refuse("/gone"));
  EXPECT_FALSE(refuse("/here"));
  topics_.keep_only({{"/here", of("a/msg/B")}, {"/other", of("a/msg/B")}});
  EXPECT_THAT(health().message(), HasSubstr("/here"));
  topics_.keep_only({});
  EXPECT_EQ(health().message(), "OK");
  EXPECT_FALSE(refuse("/gone")) << "is tried again";
  EXPECT_EQ(tried_, 3);
  EXPECT_THAT(told_, SizeIs(2)) << "and not told again";
}

TEST_F(UnreadableTopicsTest, DoNotFloodWhoIsTold) {
  for (int i = 0; i < 500; ++i) EXPECT_FALSE(refuse("/odd_" + std::to_string(i)));
  EXPECT_THAT(told_, SizeIs(ToldErrors::kMaxKinds + 1));
  EXPECT_THAT(health().complaints(), ElementsAre(HasSubstr("(and 499 more topics)")));
}

TEST_F(UnreadableTopicsTest, LetThroughThatMemoryRanOutAndTryAgain) {
  const auto fail = [] { throw std::bad_alloc(); };
  EXPECT_THROW((void)topics_.read("/large", of("a/msg/B"), fail), std::bad_alloc);
  EXPECT_TRUE(topics_.read("/large", of("a/msg/B"), [] {}));
  EXPECT_THAT(told_, IsEmpty());
}

}  // namespace
}  // namespace strata::runtime
