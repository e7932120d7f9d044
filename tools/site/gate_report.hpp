// SPDX-License-Identifier: Apache-2.0
/// What the gate found, for people and for programs.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/site/gate.hpp"

namespace strata::site {

/// `passed`, `checks` (`name`, `log`, `passed`, `text`), `shift`, and `logs` with what was measured
/// in both versions.
[[nodiscard]] nlohmann::json to_json(const GateReport& report);

/// A line a check, "FAILED" before those that did not hold.
[[nodiscard]] std::string to_text(const GateReport& report);

/// The reasons why it was refused, in one line; what was looked at, where it passed.
[[nodiscard]] std::string in_short(const GateReport& report);

/// report.html with pictures of both maps and of every drive in them, and check.json, into a folder
/// that exists. title: which version of which site. Throws OutputError.
void write_gate_report(const std::filesystem::path& folder, const std::string& title,
                       const GateTask& task, const GateReport& report);

}  // namespace strata::site
