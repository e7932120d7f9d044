// SPDX-License-Identifier: Apache-2.0
// The zones that people drew over a site's maps.
#include <system_error>

#include "components/log/whole_file.hpp"
#include "components/site/site_change.hpp"

namespace strata::site {

Zones Site::zones() const {
  std::error_code error;
  if (!std::filesystem::exists(zones_file(), error) && !error) return no_zones();
  return read_zones(zones_file());
}

Zones Site::change_zones(const std::function<void(Zones&)>& change, const Actor& actor,
                         const std::string& what, bool replaces) {
  Change decided(*this);
  Zones changed = replaces ? no_zones() : zones();
  change(changed);
  const std::string text = to_text(changed);
  (void)parse_zones(text, zones_file().string());  // what is written can be read
  log::WholeFile file(zones_file(), *disk_);
  file.stream() << text;
  file.commit();
  add_event(decided.decisions, "zones", "", actor, what);
  decided.commit();
  return changed;
}

}  // namespace strata::site
