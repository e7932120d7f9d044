// SPDX-License-Identifier: Apache-2.0
/// SHA-256 of what is added piece by piece.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace strata::log {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(const char* data, std::size_t size);
  void add(std::string_view text) { add(text.data(), text.size()); }
  /// 64 digits, in lower case. Ends the sum: call it once, and add nothing after it.
  [[nodiscard]] std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Of one text. O(size).
[[nodiscard]] std::string sha256_of(std::string_view text);

}  // namespace strata::log
