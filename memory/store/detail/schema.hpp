// SPDX-License-Identifier: Apache-2.0
/// The tables of a store, their version, and how an older version becomes the present one.
#pragma once

#include "memory/store/detail/database.hpp"

namespace strata::memory::detail {

/// "Stra" in ASCII: PRAGMA application_id of every store.
inline constexpr std::int64_t kApplicationId = 0x53747261;
/// PRAGMA user_version. Raise it with every change of the tables, and add a step to `upgrade`.
inline constexpr std::int64_t kSchemaVersion = 4;

/// Makes the tables in a new file, upgrades an older store, and refuses (InputError) a file that is
/// not a store, or one that a newer version wrote. A store opened for reading only keeps its
/// version: readers must do without the tables it does not have.
void prepare_schema(Database& database);

}  // namespace strata::memory::detail
