// SPDX-License-Identifier: Apache-2.0
/// For lists that belong together and must not lose step where memory runs out.
#pragma once

namespace strata {

/// The next push_back asks for no memory. Throws std::bad_alloc. O(1) amortized.
template <typename List>
void make_room_for_one(List& list) {
  if (list.size() == list.capacity()) list.reserve(2 * list.size() + 8);
}

}  // namespace strata
