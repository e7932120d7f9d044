// SPDX-License-Identifier: Apache-2.0
#include "components/bus/domain_claim.hpp"

#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace strata::bus {
namespace {

/// Of this process alone, for tests run side by side.
std::string purpose() { return "test-" + std::to_string(getpid()); }

TEST(DomainClaim, IsHeldByOneUntilItEnds) {
  auto first = DomainClaim::take(purpose(), 3);
  ASSERT_TRUE(first);
  EXPECT_FALSE(DomainClaim::take(purpose(), 3));
  EXPECT_TRUE(DomainClaim::take(purpose(), 4)) << "another domain";
  EXPECT_TRUE(DomainClaim::take(purpose() + "b", 3)) << "another purpose";
  DomainClaim moved = std::move(*first);
  first.reset();
  EXPECT_FALSE(DomainClaim::take(purpose(), 3));
  moved = *DomainClaim::take(purpose(), 5);
  EXPECT_TRUE(DomainClaim::take(purpose(), 3));
}

TEST(DomainClaim, EndsWithAProcessThatIsKilled) {
  const std::string shared = purpose();
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto claim = DomainClaim::take(shared, 3);
    const char said = claim ? 'y' : 'n';
    if (write(ready[1], &said, 1) != 1) _exit(1);
    for (;;) pause();
  }
  char said = 0;
  ASSERT_EQ(read(ready[0], &said, 1), 1);
  EXPECT_EQ(said, 'y');
  EXPECT_FALSE(DomainClaim::take(shared, 3));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(DomainClaim::take(shared, 3));
}

}  // namespace
}  // namespace strata::bus
