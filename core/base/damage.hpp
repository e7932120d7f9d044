// SPDX-License-Identifier: Apache-2.0
/// Files of ours that are damaged, and how they are told from somebody else's.
#pragma once

#include <algorithm>
#include <string_view>

#include "core/base/error.hpp"

namespace strata {

/// A file that we wrote, whose content is no longer what was written: cut short or altered. Whoever
/// can do without it may set it aside; a file of somebody else is an InputError only.
class DamageError : public InputError {
 public:
  using InputError::InputError;
};

/// A file that is nothing we know: somebody else's, or ours with its beginning lost. Whoever keeps
/// something under that name may set it aside.
class UnknownContentError : public InputError {
 public:
  using InputError::InputError;
};

/// Whether the file may have begun with `magic` once: it does, or a part of that is all there is,
/// or it begins with the zeros (or is as empty) as file systems leave a file that was never written
/// to the disk.
[[nodiscard]] inline bool may_have_begun_with(std::string_view bytes, std::string_view magic) {
  const std::string_view head = bytes.substr(0, magic.size());
  return magic.starts_with(head) ||
         std::all_of(head.begin(), head.end(), [](char byte) { return byte == '\0'; });
}

}  // namespace strata
