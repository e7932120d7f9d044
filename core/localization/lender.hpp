// SPDX-License-Identifier: Apache-2.0
/// Working memory that const objects keep between calls, so that no call allocates once it is warm.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace strata::localization {

/// Lends objects of type T, each to one borrower at a time, and makes a new one only when all are
/// lent. What is in a borrowed object is left over from an earlier loan: borrowers overwrite it, so
/// that lending shows in nothing but the time it takes. Thread-safe.
template <typename T>
class Lender {
 public:
  /// Returns the object when it goes out of scope.
  class Loan {
   public:
    Loan(const Lender& lender, std::unique_ptr<T> item) : lender_(lender), item_(std::move(item)) {}
    ~Loan() { lender_.take_back(std::move(item_)); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    [[nodiscard]] T& operator*() const { return *item_; }
    [[nodiscard]] T* operator->() const { return item_.get(); }

   private:
    const Lender& lender_;
    std::unique_ptr<T> item_;
  };

  [[nodiscard]] Loan borrow() const {
    const std::scoped_lock lock(mutex_);
    if (idle_.empty()) return Loan(*this, std::make_unique<T>());
    std::unique_ptr<T> item = std::move(idle_.back());
    idle_.pop_back();
    return Loan(*this, std::move(item));
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
