// SPDX-License-Identifier: Apache-2.0
#include "core/plan/plan_registration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/geometry/angle.hpp"
#include "core/plan/coarse_places.hpp"
#include "core/plan/drawn_walls.hpp"
#include "core/plan/face_field.hpp"
#include "core/plan/wall_faces.hpp"

namespace strata::plan {
namespace {

constexpr double kFieldCell_m = 0.05;
constexpr double kMaxFieldCells = 2000.0;  // along a side
constexpr double kFieldRadius_m = 0.6;
constexpr std::size_t kPlaces = 24;
/// Another place: so far off at the corners of what the map shows, or so much turned.
constexpr double kElsewhere_m = 0.7;
/// How far from a wall counts in the end, and how far it may lie to be the same.
constexpr double kFits_m = 0.1;
constexpr double kBeforeFace_m = 0.12;
constexpr double kMaxThicker_m = 0.5;
constexpr int kIterations = 12;
/// Spreads that the unknown offset and scale have before anything is seen, as of `kWeighsAs` faces.
constexpr double kThickerStddev_m = 0.1;
constexpr double kScaleStddev = 0.01;
constexpr double kWeighsAs = 30.0;

/// The unknowns: a point p of the map lies at k R(turn) (p - middle) + at in the plan, and built
/// faces lie `out_m` before drawn ones.
struct Fit {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double turn_rad = 0.0;
  double log_k = 0.0;
  double out_m = 0.0;
};

/// One look of a map's face at the plan.
struct Look {
  Eigen::Vector2d turned;  ///< k R (p - middle)
  const WallFace* drawn = nullptr;
  double across_m = 0.0;  ///< before the drawn face, less the offset
  double distance_m = 0.0;
};

/// Cells of a field over these faces: coarser where it would not fit into memory.
double field_cell_m(const std::vector<WallFace>& faces) {
  Eigen::AlignedBox2d extent;
  for (const WallFace& face : faces) extent.extend(face.at_m);
  if (extent.isEmpty()) return kFieldCell_m;
  return std::max(kFieldCell_m, extent.sizes().maxCoeff() / kMaxFieldCells);
}

FaceField field_of(std::vector<WallFace> faces, double radius_m) {
  const double cell_m = field_cell_m(faces);
  return {std::move(faces), cell_m, std::max(radius_m, 2.0 * cell_m)};
}

class Registration {
 public:
  Registration(const ReflectionGrid& plan, const ReflectionGrid& map, const SurfaceLayer& surfaces,
               const PlanConfig& config)
      : config_(config),
        map_(map),
        seen_(seen_faces(map, surfaces)),
        drawn_(field_of(thinned(drawn_faces(drawn_walls(plan)), kFieldCell_m), kFieldRadius_m)),
        middle_(middle_of(seen_)) {}

  PlanRegistration run() {
    PlanRegistration result;
    result.verdict = PlanVerdict::kNothingSeen;
    if (seen_.empty()) return result;
    result.verdict = PlanVerdict::kNothingDrawn;
    if (drawn_.faces().empty()) return result;
    seen_field_.emplace(field_of(seen_, 2.0 * kFits_m));
    std::vector<PlanPlace> places;
    for (const CoarsePlace& coarse : coarse_places(seen_, drawn_.faces(), kPlaces, guess())) {
      const PlanPlace place = refined(coarse);
      if (is_near(place)) places.push_back(place);
    }
    std::stable_sort(places.begin(), places.end(),
                     [](const PlanPlace& a, const PlanPlace& b) { return a.score > b.score; });
    result.verdict = PlanVerdict::kPoor;
    if (places.empty()) return result;
    result.best = places.front();
    for (const PlanPlace& place : places) {
      if (!is_elsewhere(place, result.best)) continue;
      result.rival = place;
      break;
    }
    result.verdict = verdict_on(result);
    return result;
  }

 private:
  [[nodiscard]] std::optional<CoarseGuess> guess() const {
    if (!config_.near) return std::nullopt;
    // A turn about the plan's origin moves the map's middle as far as it lies from there.
    const Pose2 plan_from_site = inverse(*config_.near);
    const Eigen::Vector2d at = plan_from_site * middle_;
    return CoarseGuess{{at.x(), at.y(), plan_from_site.theta},
                       config_.near_m + config_.near_rad * at.norm(),
                       config_.near_rad};
  }
  [[nodiscard]] bool is_near(const PlanPlace& place) const {
    if (!config_.near) return true;
    const Pose2& pose = place.site_from_plan.pose;
    return translation_distance(pose, *config_.near) <= config_.near_m &&
           std::abs(angle_difference(pose.theta, config_.near->theta)) <= config_.near_rad;
  }

  [[nodiscard]] Look look(const WallFace& face, const Fit& fit) const {
    const double c = std::cos(fit.turn_rad);
    const double s = std::sin(fit.turn_rad);
    Eigen::Matrix2d turn;
    turn << c, -s, s, c;
    Look seen;
    seen.turned = std::exp(fit.log_k) * (turn * (face.at_m - middle_));
    const Eigen::Vector2d at = seen.turned + fit.at;
    seen.drawn = drawn_.nearest(at, turn * face.normal);
    if (seen.drawn == nullptr) return seen;
    const Eigen::Vector2d from = at - seen.drawn->at_m - fit.out_m * seen.drawn->normal;
    seen.across_m = seen.drawn->normal.dot(from);
    seen.distance_m = from.norm();
    return seen;
  }

  /// One step of iteratively re-weighted least squares; the length of the step in metres.
  double step(Fit& fit, double spread_m, bool has_shape) const {
    using Vector5 = Eigen::Matrix<double, 5, 1>;
    Eigen::Matrix<double, 5, 5> hessian = Eigen::Matrix<double, 5, 5>::Zero();
    Vector5 gradient = Vector5::Zero();
    for (const WallFace& face : seen_) {
      const Look seen = look(face, fit);
      if (seen.drawn == nullptr) continue;
      const double share = 1.0 + seen.distance_m * seen.distance_m / (spread_m * spread_m);
      const double weight = 1.0 / (share * share);  // Geman-McClure
      const Eigen::Vector2d& n = seen.drawn->normal;
      Vector5 j;
      j << n.x(), n.y(), n.y() * seen.turned.x() - n.x() * seen.turned.y(), n.dot(seen.turned),
          -1.0;
      hessian += weight * j * j.transpose();
      gradient += weight * seen.across_m * j;
    }
    const double noise = kWeighsAs * kFits_m * kFits_m;
    const double of_scale = noise / (kScaleStddev * kScaleStddev);
    const double of_out = noise / (0.25 * kThickerStddev_m * kThickerStddev_m);
    hessian(3, 3) += of_scale;
    gradient(3) += of_scale * fit.log_k;
    hessian(4, 4) += of_out;
    gradient(4) += of_out * fit.out_m;
    hessian.diagonal().head<3>().array() += 1e-6;
    for (const int fixed : {3, 4}) {
      if (has_shape && !(fixed == 3 && config_.keeps_scale)) continue;
      hessian.row(fixed).setZero();
      hessian.col(fixed).setZero();
      hessian(fixed, fixed) = 1.0;
      gradient(fixed) = 0.0;
    }
    const Vector5 change = -hessian.ldlt().solve(gradient);
    fit.at += change.head<2>();
    fit.turn_rad = wrap_angle(fit.turn_rad + change(2));
    const double most = std::log1p(config_.max_scale_error);
    fit.log_k = std::clamp(fit.log_k + change(3), -most, most);
    fit.out_m = std::clamp(fit.out_m + change(4), -0.5 * kMaxThicker_m, 0.5 * kMaxThicker_m);
    return change.head<2>().norm() + 10.0 * std::abs(change(2));
  }

  void iterate(Fit& fit, double spread_m, bool has_shape) const {
    for (int i = 0; i < kIterations; ++i) {
      if (step(fit, spread_m, has_shape) < 1e-4) break;
    }
  }

  [[nodiscard]] PlanPlace refined(const CoarsePlace& coarse) const {
    Fit rough;
    rough.at = coarse.plan_from_map.translation();
    rough.turn_rad = coarse.plan_from_map.theta;
    iterate(rough, 0.3, false);
    PlanPlace best;
    // Between the two faces of a wall that is drawn too thick both look near.
    for (const double out_m : {0.0, -0.05, -0.1, 0.07}) {
      Fit fit = rough;
      fit.out_m = out_m;
      for (const double spread_m : {0.15, 0.08, 0.05}) iterate(fit, spread_m, true);
      const PlanPlace place = judged(fit);
      if (place.score > best.score) best = place;
    }
    return best;
  }

  [[nodiscard]] PlanPlace judged(const Fit& fit) const {
    PlanPlace place;
    const double scale = std::exp(-fit.log_k);
    const double turn = wrap_angle(-fit.turn_rad);
    const Eigen::Vector2d at = middle_ - Pose2{0.0, 0.0, turn} * Eigen::Vector2d(scale * fit.at);
    place.site_from_plan = {{at.x(), at.y(), turn}, scale};
    place.thicker_m = 2.0 * fit.out_m;
    double squares = 0.0;
    std::size_t fits = 0;
    for (const WallFace& face : seen_) {
      const Look seen = look(face, fit);
      if (seen.drawn == nullptr || seen.distance_m > kFits_m) continue;
      ++fits;
      squares += seen.across_m * seen.across_m;
    }
    place.map_share = static_cast<double>(fits) / static_cast<double>(seen_.size());
    place.residual_m = fits == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(fits));
    place.plan_share = plan_share(place, fit.out_m);
    const double sum = place.map_share + place.plan_share;
    place.score = sum > 0.0 ? 2.0 * place.map_share * place.plan_share / sum : 0.0;
    return place;
  }

  [[nodiscard]] double plan_share(const PlanPlace& place, double out_m) const {
    std::size_t open = 0;
    std::size_t fits = 0;
    const Pose2 turn{0.0, 0.0, place.site_from_plan.pose.theta};
    for (const WallFace& face : drawn_.faces()) {
      const Eigen::Vector2d normal = turn * face.normal;
      const Eigen::Vector2d at =
          place.site_from_plan * Eigen::Vector2d(face.at_m + out_m * face.normal);
      if (!is_free(map_.get(map_.cell_at(at + kBeforeFace_m * normal)))) continue;
      ++open;
      const WallFace* seen = seen_field_->nearest(at, normal);
      if (seen != nullptr && (seen->at_m - at).norm() < kFits_m) ++fits;
    }
    return open == 0 ? 0.0 : static_cast<double>(fits) / static_cast<double>(open);
  }

  [[nodiscard]] bool is_elsewhere(const PlanPlace& a, const PlanPlace& b) const {
    // Where each would have the same walls of the map.
    const auto in_plan = [&](const PlanPlace& place, const Eigen::Vector2d& point) {
      return Eigen::Vector2d(inverse(place.site_from_plan.pose) * point /
                             place.site_from_plan.scale);
    };
    double most_m = 0.0;
    for (std::size_t i = 0; i < seen_.size(); i += 1 + seen_.size() / 100) {
      const Eigen::Vector2d& point = seen_[i].at_m;
      most_m = std::max(most_m, (in_plan(a, point) - in_plan(b, point)).norm());
    }
    return most_m > kElsewhere_m;
  }

  [[nodiscard]] PlanVerdict verdict_on(const PlanRegistration& found) const {
    if (found.best.score < config_.min_score) return PlanVerdict::kPoor;
    const double off = std::abs(found.best.site_from_plan.scale - 1.0);
    if (!config_.keeps_scale && off > 0.98 * config_.max_scale_error) {
      return PlanVerdict::kWrongScale;
    }
    if (found.rival && found.rival->score > config_.max_rival_share * found.best.score) {
      return PlanVerdict::kAmbiguous;
    }
    return PlanVerdict::kGood;
  }

  PlanConfig config_;
  const ReflectionGrid& map_;
  std::vector<WallFace> seen_;
  FaceField drawn_;
  Eigen::Vector2d middle_;
  std::optional<FaceField> seen_field_;
};

}  // namespace

PlanRegistration register_plan(const ReflectionGrid& plan, const ReflectionGrid& map,
                               const SurfaceLayer& surfaces, const PlanConfig& config) {
  return Registration(plan, map, surfaces, config).run();
}

}  // namespace strata::plan
