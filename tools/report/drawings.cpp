// SPDX-License-Identifier: Apache-2.0
#include "tools/report/drawings.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <system_error>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::report {
namespace {

constexpr std::size_t kNamed = 4;

/// Without the place: files lie beside their place while they are made.
std::string reason_of(const std::exception& error) {
  if (const auto* ours = dynamic_cast<const Error*>(&error)) {
    return ours->problem() + "; " + ours->remedy();
  }
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    return "memory ran out; free some, or raise the limit (`ulimit -v`)";
  }
  return std::string(error.what()) + "; report this with the log at hand";
}

}  // namespace

void Drawings::add(const fs::path& file, const std::function<void()>& draw) {
  try {
    draw();
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& error) {
    std::error_code ignored;
    fs::remove_all(file, ignored);
    if (missing_.empty()) reason_ = reason_of(error);
    missing_.push_back(file.filename().string());
  }
}

std::string Drawings::what_is_missing() const {
  if (missing_.empty()) return "";
  std::string names = missing_.front();
  for (std::size_t i = 1; i < std::min(missing_.size(), kNamed); ++i) names += ", " + missing_[i];
  if (missing_.size() > kNamed) {
    names += " and " + std::to_string(missing_.size() - kNamed) + " more";
  }
  return "all results are there but for pictures (" + names + "): " + reason_;
}

void draw(Drawings* drawings, const fs::path& file, const std::function<void()>& draw) {
  if (drawings != nullptr) {
    drawings->add(file, draw);
  } else {
    draw();
  }
}

}  // namespace strata::report
