// SPDX-License-Identifier: Apache-2.0
/// YAML files and --set options in, checked config structs out; and back, and as reference pages.
///
///     YAML::Node document = settings::load_document("office.yaml");   // "version: 1" checked
///     settings::apply_overrides(document, {"laser.beams=360"});       // --set, in order
///     auto config = settings::read_config<SimulationConfig>(document, "office.yaml");
#pragma once

#include "components/settings/config_reader.hpp"   // IWYU pragma: export
#include "components/settings/config_writer.hpp"   // IWYU pragma: export
#include "components/settings/key_tree.hpp"        // IWYU pragma: export
#include "components/settings/old_keys.hpp"        // IWYU pragma: export
#include "components/settings/presets.hpp"         // IWYU pragma: export
#include "components/settings/reference_page.hpp"  // IWYU pragma: export
#include "components/settings/yaml_document.hpp"   // IWYU pragma: export
