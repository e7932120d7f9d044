// SPDX-License-Identifier: Apache-2.0
/// Working memory that const objects keep between calls, so that no call allocates once it is warm.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace strata::localization {

/// Hands out objects of type T, each to one user at a time, and makes a new one only when all
/// are in use. What is in an object is left over from an earlier use: users overwrite it, so that
/// pooling shows in nothing but the time it takes. Thread-safe.
template <typename T>
class ObjectPool {
 public:
  /// Returns the object when it goes out of scope.
  class Pooled {
   public:
    Pooled(const ObjectPool& pool, std::unique_ptr<T> item) : pool_(pool), item_(std::move(item)) {}
    ~Pooled() { pool_.take_back(std::move(item_)); }
    Pooled(const Pooled&) = delete;
    Pooled& operator=(const Pooled&) = delete;
    [[nodiscard]] T& operator*() const { return *item_; }
    [[nodiscard]] T* operator->() const { return item_.get(); }

   private:
    const ObjectPool& pool_;
    std::unique_ptr<T> item_;
  };

  [[nodiscard]] Pooled acquire() const {
    const std::scoped_lock lock(mutex_);
    if (idle_.empty()) return Pooled(*this, std::make_unique<T>());
    std::unique_ptr<T> item = std::move(idle_.back());
    idle_.pop_back();
    return Pooled(*this, std::move(item));
  }

 private:
  void take_back(std::unique_ptr<T> item) const {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(item));
  }
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<T>> idle_;
};

}  // namespace strata::localization
