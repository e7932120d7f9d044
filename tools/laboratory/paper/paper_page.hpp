// SPDX-License-Identifier: Apache-2.0
/// The rows as one page, as a table of text, and as JSON.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/laboratory/paper/make_figures.hpp"

namespace strata::paper {

/// "N held, N not held, N not made, of N".
[[nodiscard]] std::string sum_of(std::span<const Row> rows);

/// A Markdown table of the rows, and the sum.
[[nodiscard]] std::string text_table(std::span<const Row> rows);

/// An object a row, with `id`, `paper`, `title`, `shows`, `criterion`, `material`, `verdict`,
/// `reason`, `took_s`, `pictures` and `numbers`; what is missing is null.
[[nodiscard]] nlohmann::json to_json(std::span<const Row> rows);

/// Writes index.html, which is self-contained, results.json, and every picture as a file beside
/// them. The folder must exist. Returns which pictures are missing and why, or nothing. Throws
/// OutputError.
std::string write_page(const std::filesystem::path& folder, std::span<const Row> rows);

}  // namespace strata::paper
