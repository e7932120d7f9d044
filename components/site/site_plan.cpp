// SPDX-License-Identifier: Apache-2.0
// The floor plan of a site.
#include <system_error>
#include <utility>

#include "components/site/site_change.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {

bool Site::has_plan() const {
  std::error_code error;
  return fs::exists(folder_ / kPlanFolder, error);
}

std::optional<FloorPlan> Site::plan() const {
  if (!has_plan()) return std::nullopt;
  return read_plan(folder_ / kPlanFolder);
}

void Site::set_plan(FloorPlan plan, const Actor& actor) {
  Change decided(*this);
  if (has_plan()) {
    throw InputError(folder_.string(), "has a plan already, which does not move by itself",
                     "take it away first: `strata site plan SITE remove`");
  }
  plan.placed = actor;
  log::remove_left_over(folder_ / kPlanFolder);
  write_plan(folder_ / kPlanFolder, plan, *disk_);
  add_event(decided.decisions, "plan", plan.version, actor, "set " + plan.drawing.name);
  decided.commit();
}

void Site::remove_plan(const Actor& actor) {
  Change decided(*this);
  if (!has_plan()) {
    throw InputError(folder_.string(), "has no plan", "`strata site plan SITE set` takes one");
  }
  // Out of sight at once: half a plan is none.
  const fs::path aside = log::staged_name(folder_ / kPlanFolder);
  disk_->rename(folder_ / kPlanFolder, aside);
  disk_->sync(folder_);
  disk_->remove(aside);
  add_event(decided.decisions, "plan", "", actor, "removed");
  decided.commit();
}

}  // namespace strata::site
