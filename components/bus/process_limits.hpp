// SPDX-License-Identifier: Apache-2.0
/// What the system lets this process have.
#pragma once

namespace strata::bus {

/// Throws OutputError where the limits on address space, memory or threads leave too little for a
/// participant. Fast DDS ends the whole process where one of its threads cannot be made, and
/// nobody can catch that. Takes about a millisecond.
void require_room_for_participant();

}  // namespace strata::bus
