// SPDX-License-Identifier: Apache-2.0
/// Whether what is seen now was kept in the same frame: of a map that began anew, what was learned
/// in the old one says nothing, and must not be mixed with it.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace strata {

/// Of `judged` beams, points or walls of which something was kept, so many are where they were.
struct FrameLook {
  std::size_t agreed = 0;
  std::size_t judged = 0;
};

/// Decides by places, not by looks: where a robot stands, much may have been moved, or little says
/// where it is.
class FrameWatch {
 public:
  enum class Verdict { kOpen, kSame, kOther };

  static constexpr double kApart_m = 1.0;        ///< between places
  static constexpr std::size_t kMinJudged = 50;  ///< fewer say nothing of a place
  /// As many places speak together; that many at most before the watch is over.
  static constexpr std::size_t kPlaces = 4;
  static constexpr double kSame = 0.75;   ///< at one place: no other frame looks like that
  static constexpr double kOther = 0.25;  ///< on average: the building was not rebuilt, surely

  /// A look from there, in the map frame [m]. kSame and kOther are final.
  Verdict add(const Eigen::Vector2d& place_m, const FrameLook& look) {
    if (verdict_ != Verdict::kOpen || look.judged == 0) return verdict_;
    Place& place = at(place_m);
    place.sum.agreed += look.agreed;
    place.sum.judged += look.judged;
    decide();
    return verdict_;
  }

  /// It is open, and what is known of some place has not been seen there so far.
  [[nodiscard]] bool is_in_doubt() const { return is_in_doubt_; }

 private:
  struct Place {
    Eigen::Vector2d at_m;
    FrameLook sum;
  };
  Place& at(const Eigen::Vector2d& place_m) {
    for (Place& place : places_) {
      if ((place.at_m - place_m).norm() < kApart_m) return place;
    }
    return places_.emplace_back(Place{place_m, {}});
  }
  void decide() {
    std::size_t places = 0;
    double sum = 0.0;
    for (const Place& place : places_) {
      if (place.sum.judged < kMinJudged) continue;
      const double share =
          static_cast<double>(place.sum.agreed) / static_cast<double>(place.sum.judged);
      if (share >= kSame) verdict_ = Verdict::kSame;
      ++places;
      sum += share;
    }
    is_in_doubt_ = verdict_ == Verdict::kOpen && places > 0;
    if (verdict_ != Verdict::kOpen || places < kPlaces) return;
    is_in_doubt_ = false;
    verdict_ = sum / static_cast<double>(places) < kOther ? Verdict::kOther : Verdict::kSame;
  }

  std::vector<Place> places_;
  Verdict verdict_ = Verdict::kOpen;
  bool is_in_doubt_ = false;
};

}  // namespace strata
