// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace strata {
namespace {

TEST(WorkerPool, VisitsEveryIndexOnceForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 8}) {
    WorkerPool pool(threads);
    for (const std::size_t count : {0U, 1U, 7U, 64U, 1'000U}) {
      for (const std::size_t chunk_size : {1U, 7U, 64U, 5'000U}) {
        std::vector<std::atomic<int>> visits(count);
        pool.for_chunks(count, chunk_size, [&](std::size_t begin, std::size_t end, std::size_t k) {
          EXPECT_EQ(begin, k * chunk_size);
          EXPECT_LE(end - begin, chunk_size);
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        for (const auto& n : visits) ASSERT_EQ(n.load(), 1);
      }
    }
  }
}

TEST(WorkerPool, GivesTheSameSumForAnyNumberOfThreads) {
  auto sum_with = [](int threads) {
    WorkerPool pool(threads);
    std::vector<double> partial(100);
    pool.for_chunks(10'000, 100, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
      for (std::size_t i = begin; i < end; ++i) partial[chunk] += std::sin(static_cast<double>(i));
    });
    double sum = 0.0;
    for (const double p : partial) sum += p;
    return sum;
  };
  const double expected = sum_with(1);
  EXPECT_EQ(sum_with(2), expected);
  EXPECT_EQ(sum_with(8), expected);
}

// A thread sanitizer needs room of its own, and ends the process when it gets none.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(WorkerPool, ThatGetsNoMoreThreadsSaysSoAndJoinsThoseItGot) {
  const auto make_too_many = [] {
    rlimit limit{256U << 20U, 256U << 20U};  // 1000 threads have stacks of 8 MB
    setrlimit(RLIMIT_AS, &limit);
    try {
      const WorkerPool pool(1000);
    } catch (const std::system_error&) {
      _exit(0);
    }
    _exit(1);
  };
  EXPECT_EXIT(make_too_many(), testing::ExitedWithCode(0), "");
}
#endif

TEST(WorkerPool, RethrowsTheFirstErrorInChunkOrderAndStaysUsable) {
  for (const int threads : {1, 4}) {
    WorkerPool pool(threads);
    std::atomic<int> done = 0;
    try {
      pool.for_chunks(100, 10, [&](std::size_t, std::size_t, std::size_t chunk) {
        if (chunk == 3 || chunk == 7) throw std::runtime_error(std::to_string(chunk));
        ++done;
      });
      ADD_FAILURE() << "no error";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "3");
    }
    EXPECT_EQ(done, 8);
    pool.for_chunks(10, 1, [&](std::size_t, std::size_t, std::size_t) { ++done; });
    EXPECT_EQ(done, 18);
  }
}

TEST(WorkerPool, TwoPoolsWorkSideBySideAndNested) {
  WorkerPool outer(2);
  std::atomic<int> count = 0;
  outer.for_chunks(4, 1, [&](std::size_t, std::size_t, std::size_t) {
    WorkerPool inner(2);
    inner.for_chunks(10, 3, [&](std::size_t begin, std::size_t end, std::size_t) {
      count += static_cast<int>(end - begin);
    });
  });
  EXPECT_EQ(count, 40);
}

TEST(WorkerPool, ZeroThreadsMeansOnePerCore) { EXPECT_GE(WorkerPool(0).threads(), 1); }

}  // namespace
}  // namespace strata
