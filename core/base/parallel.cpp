// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace strata {

struct WorkerPool::State {
  std::mutex mutex;
  std::condition_variable work_ready;
  std::condition_variable work_done;
  std::vector<std::thread> workers;
  std::size_t generation = 0;
  int busy = 0;
  bool stop = false;

  const std::function<void(std::size_t, std::size_t, std::size_t)>* body = nullptr;
  std::size_t count = 0;
  std::size_t chunk_size = 1;
  std::size_t chunks = 0;
  std::atomic<std::size_t> next_chunk{0};
  std::exception_ptr error;
  std::size_t error_chunk = 0;
};

WorkerPool::WorkerPool(int threads)
    : threads_(threads > 0 ? threads
                           : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
      state_(std::make_unique<State>()) {
  const auto work = [this] {
    State& s = *state_;
    std::size_t seen = 0;
    std::unique_lock lock(s.mutex);
    while (true) {
      s.work_ready.wait(lock, [&] { return s.stop || s.generation != seen; });
      if (s.stop) return;
      seen = s.generation;
      lock.unlock();
      run_chunks();
      lock.lock();
      if (--s.busy == 0) s.work_done.notify_one();
    }
  };
  try {
    for (int i = 1; i < threads_; ++i) state_->workers.emplace_back(work);
  } catch (...) {
    join();  // threads that nobody joins would end the process
    throw;
  }
}

WorkerPool::~WorkerPool() { join(); }

void WorkerPool::join() {
  {
    const std::scoped_lock lock(state_->mutex);
    state_->stop = true;
  }
  state_->work_ready.notify_all();
  for (std::thread& worker : state_->workers) worker.join();
}

void WorkerPool::run_chunks() {
  State& s = *state_;
  while (true) {
    const std::size_t chunk = s.next_chunk.fetch_add(1);
    if (chunk >= s.chunks) return;
    const std::size_t begin = chunk * s.chunk_size;
    try {
      (*s.body)(begin, std::min(s.count, begin + s.chunk_size), chunk);
    } catch (...) {
      const std::scoped_lock lock(s.mutex);
      if (!s.error || chunk < s.error_chunk) {
        s.error = std::current_exception();
        s.error_chunk = chunk;
      }
    }
  }
}

void WorkerPool::for_chunks(
    std::size_t count, std::size_t chunk_size,
    const std::function<void(std::size_t, std::size_t, std::size_t)>& body) {
  State& s = *state_;
  {
    const std::scoped_lock lock(s.mutex);
    s.body = &body;
    s.count = count;
    s.chunk_size = chunk_size;
    s.chunks = (count + chunk_size - 1) / chunk_size;
    s.next_chunk = 0;
    s.error = nullptr;
    s.busy = threads_ - 1;
    ++s.generation;
  }
  if (threads_ > 1) s.work_ready.notify_all();
  run_chunks();
  std::unique_lock lock(s.mutex);
  s.work_done.wait(lock, [&] { return s.busy == 0; });
  if (s.error) std::rethrow_exception(s.error);
}

}  // namespace strata
