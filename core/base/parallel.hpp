// SPDX-License-Identifier: Apache-2.0
/// Data-parallel loops whose result does not depend on the number of threads.
///
/// Work is cut into chunks of a fixed size that the caller chooses, never by the number of threads;
/// a caller that sums keeps one partial sum per chunk and adds them in chunk order.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace strata {

/// A fixed set of threads. One object serves one caller at a time; two objects are independent.
class WorkerPool {
 public:
  /// threads: 1 runs everything on the caller; 0 takes one per core.
  explicit WorkerPool(int threads = 1);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  [[nodiscard]] int threads() const { return threads_; }

  /// Calls body(begin, end, chunk) for [0, count) cut into chunks of chunk_size, in any order and
  /// on any thread; returns when all are done. The first exception of a body (in chunk order) is
  /// rethrown. Requires chunk_size > 0.
  void for_chunks(std::size_t count, std::size_t chunk_size,
                  const std::function<void(std::size_t, std::size_t, std::size_t)>& body);

 private:
  struct State;
  void run_chunks();
  void join();
  int threads_;
  std::unique_ptr<State> state_;
};

}  // namespace strata
