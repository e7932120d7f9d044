// SPDX-License-Identifier: Apache-2.0
/// The page of the metrics that the live view answers.
#pragma once

#include <string>

namespace strata::reference {

/// Markdown: a row a metric.
[[nodiscard]] std::string metrics_page();

}  // namespace strata::reference
