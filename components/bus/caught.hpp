// SPDX-License-Identifier: Apache-2.0
/// Where exceptions end that nobody above may see: in callbacks on threads of the middleware, and
/// in tasks of threads of our own.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <mutex>
#include <string>
#include <string_view>

namespace strata::bus {

/// Counts what was thrown, and keeps the last of it. Thread safe; needs no memory of its own, since
/// the lack of it may be what was thrown.
class Caught {
 public:
  /// Runs body; what it throws ends here. Whether nothing was thrown.
  template <typename Body>
  bool run(Body&& body) noexcept {
    try {
      body();
      return true;
    } catch (const std::exception& error) {
      note(error.what());
    } catch (...) {
      note("an exception of unknown type");
    }
    return false;
  }

  [[nodiscard]] std::uint64_t count() const {
    const std::lock_guard lock(mutex_);
    return count_;
  }
  /// What the last one said, its beginning; empty when there was none.
  [[nodiscard]] std::string last() const {
    const std::lock_guard lock(mutex_);
    return {last_.data(), length_};
  }

 private:
  void note(std::string_view what) noexcept {
    const std::lock_guard lock(mutex_);
    ++count_;
    length_ = std::min(what.size(), last_.size());
    std::copy_n(what.begin(), length_, last_.begin());
  }

  mutable std::mutex mutex_;
  std::uint64_t count_ = 0;
  std::array<char, 240> last_{};
  std::size_t length_ = 0;
};

}  // namespace strata::bus
