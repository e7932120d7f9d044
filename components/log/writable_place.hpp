// SPDX-License-Identifier: Apache-2.0
/// Whether something could be written at a place, before there is a reason to write it.
#pragma once

#include <filesystem>

namespace strata::log {

/// Looks, and writes nothing: a file could be written at this path, its folders made where they are
/// missing. Throws OutputError that names what is in the way. A disk may be full all the same.
void require_file_place(const std::filesystem::path& file);

/// The same of a folder into which files go.
void require_folder_place(const std::filesystem::path& folder);

}  // namespace strata::log
