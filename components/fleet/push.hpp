// SPDX-License-Identifier: Apache-2.0
/// A robot's own visits on their way to the server.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "components/fleet/connection.hpp"
#include "components/fleet/visits.hpp"
#include "core/scan/spacing.hpp"

namespace strata::fleet {

enum class PushOutcome {
  kSent,      ///< the server has it from now on
  kThere,     ///< ... had it already
  kReleased,  ///< it is part of a version of the site, whoever drove it
  kClash,     ///< the server has another visit of this robot under its number
};
[[nodiscard]] const char* name_of(PushOutcome outcome);

struct PushedVisit {
  VisitName name;
  std::string whole;  ///< the hash of all of its scans, also of those that were forgotten since
  int run = 0;
  std::size_t scans = 0;
  double path_m = 0.0;
  std::size_t bytes = 0;  ///< that were sent
  /// Hash of the version that it was told relative to; empty: it was sent by itself, or not at all.
  std::string relative_to = {};
  PushOutcome outcome = PushOutcome::kSent;
};

/// Sends every run of a MAPS folder that the server does not have: one visit, one transaction, so
/// that a cut at any moment loses nothing, and to do it again repeats nothing. The maps must hold a
/// visit of a version of the site: that is how one knows that they are in its frame. What is sent
/// is spaced so; a visit that is there with fewer scans, or with as many over the same path, and
/// the same begin and end, is there. coding: visits are told relative to it where the server has
/// released it; null: by themselves. told: of each visit once it is decided. Throws InputError for
/// maps that are not, or a connection that is no robot of `site`; and as Connection does: what was
/// told before that is on the server.
void push(Connection& connection, const std::string& site, const std::filesystem::path& maps,
          const std::function<void(const PushedVisit&)>& told, const SpacingConfig& spacing = {},
          const Coding* coding = nullptr);

/// What to say of a visit that stays here.
[[nodiscard]] InputError clash_error(const Connection& connection, const VisitName& visit);

}  // namespace strata::fleet
