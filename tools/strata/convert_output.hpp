// SPDX-License-Identifier: Apache-2.0
/// Where `strata convert` writes: a file, or the folder of a bag.
#pragma once

#include <filesystem>
#include <functional>

#include "tools/strata/output_directory.hpp"

namespace strata::tools {

/// A bag is a folder. For an OUT that names a storage file the file alone is put there; `write`
/// fills a folder. Throws OutputError.
void write_bag_or_file(const std::filesystem::path& out, StagedPaths& staged,
                       const std::function<void(const std::filesystem::path&)>& write);

/// Told before the work: throws OutputError where OUT cannot be written, or is a folder that a file
/// would replace.
void require_writable(const std::filesystem::path& out, bool is_file);

/// Writing would end what is being read: throws OutputError where OUT is IN, or a file of the bag
/// that IN is.
void refuse_to_write_over(const std::filesystem::path& in, const std::filesystem::path& out);

}  // namespace strata::tools
