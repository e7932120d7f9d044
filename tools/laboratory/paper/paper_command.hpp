// SPDX-License-Identifier: Apache-2.0
/// `strata-experiments paper NAME...`.
#pragma once

namespace strata::paper {

/// words: from `paper` on. scenarios: the folder by default. Returns the exit status.
int paper_command(int count, char** words, const char* scenarios);

}  // namespace strata::paper
