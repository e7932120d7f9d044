// SPDX-License-Identifier: Apache-2.0
/// What is used through pointers to it only: it is neither copied nor sliced.
#pragma once

namespace strata {

class Interface {
 public:
  Interface() = default;
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;
  virtual ~Interface() = default;
};

}  // namespace strata
