// SPDX-License-Identifier: Apache-2.0
#include "components/settings/text_file.hpp"

#include <system_error>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::settings {

void require_text_file(const fs::path& file) {
  if (file.empty()) throw InputError("''", "is an empty name", "name a file");
  std::error_code error;
  const fs::file_type type = fs::status(file, error).type();
  if (type != fs::file_type::character && type != fs::file_type::block) return;
  throw InputError(file.string(), "is a device, not a file", "name a file");
}

}  // namespace strata::settings
