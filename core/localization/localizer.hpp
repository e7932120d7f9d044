// SPDX-License-Identifier: Apache-2.0
/// Monte-Carlo localization with any sensor model, and with the patch state of particles for maps
/// that have one [stachniss2005patch, section IV].
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/state_archive.hpp"
#include "core/geometry/odometry_gate.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/localization/beyond_map.hpp"
#include "core/localization/companion_scans.hpp"
#include "core/localization/localizer_config.hpp"
#include "core/localization/particle_set.hpp"
#include "core/localization/patch_states.hpp"
#include "core/localization/place_finder.hpp"
#include "core/localization/place_hypotheses.hpp"
#include "core/localization/place_watch.hpp"
#include "core/localization/pose_score.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/localization/start_confirmation.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/scanner_turns.hpp"

namespace strata::localization {

/// The outcome of one scan.
struct LocalizationResult {
  /// map_from_robot at the scan's stamp: mean and covariance of all particles; while ambiguous the
  /// likeliest place, and the covariance of all particles about it.
  Pose2Gaussian pose;
  LocalizationHealth health;
  /// Probability that the pose is within 0.5 m of the truth, 0 to 1: place_score, times the
  /// probability of the place while there are several that fit.
  double score = 0.0;
  double place_score = 0.0;  ///< as if no other place fitted (pose_score.hpp)
  double effective_sample_size = 0.0;
  std::size_t particles = 0;
  bool weighed = false;    ///< false: moved by odometry only (gated, or nothing usable in the scan)
  bool converged = false;  ///< the spread is below recovery.uncertain_stddev_m, and not ambiguous
  /// Half of the last weighed scan (beyond_map.coast_share) shows what the map says nothing of: an
  /// unknown room, a place beside the map.
  bool is_beyond_map = false;
  /// Several places explain what was seen, and none has refuted the others by the margin
  /// (global_search.places), or it is still looked for any, or the one that is left has not been
  /// confirmed (global_search.confirmation), or the search beside a doubted pose has found some
  /// that fit better (global_search.watch).
  bool is_ambiguous = false;
  /// The pose is doubted, and the robot is looked for elsewhere too: beside it
  /// (global_search.watch), by random poses (recovery.inject) or in all free space
  /// (recovery.restart_after).
  bool is_recovering = false;
  /// Those places, the likeliest first, but for the pose itself, which is the last when others
  /// were found beside it; one that is left and not confirmed has the score for its
  /// probability. Empty when not ambiguous, and while no place was found.
  std::vector<PlaceBelief> places;
  std::vector<SubmapBelief> submaps;  ///< one a sub-map; empty for maps without
  /// With this scan the search beside a doubted pose took over (global_search.watch): so far from
  /// where the robot was believed to be it is now. Nothing: it did not.
  std::optional<double> relocated_m;
};

/// Of several scanners (told by their mountings) one has the turn, and what the others saw just
/// before is weighed with it. Per scan: motion, sub-map transition, weight, estimate; resampling
/// comes first at the next weighed scan, so that `particles()` always shows the weighted set of
/// which the paper's error is the mean. Bit-identical for the same (config, model, seed,
/// observations) at any number of threads.
class Localizer {
 public:
  /// Throws ConfigError, and std::invalid_argument for a null model. threads as in WorkerPool.
  Localizer(const LocalizerConfig& config, std::shared_ptr<const SensorModel> model,
            std::uint64_t seed, int threads = 1);

  /// Starts from a pose: particles drawn from the Gaussian. Forgets everything but the seed. Throws
  /// InputError for a mean or a covariance with a number that is not finite, and goes on as before.
  void initialize(const Pose2Gaussian& map_from_robot);
  /// Starts from nowhere: the first scans are looked for in the whole map, and the places where
  /// they fit are followed until one has refuted the others. With global_search.is_used off uniform
  /// over the free cells of `map` and all headings, annealed and roughened. Throws InputError when
  /// no cell is free.
  void initialize_global(const ReflectionGrid& map);
  /// Again in the free space given last. Throws InputError when there is none.
  void initialize_global();
  /// Where recovery may look for the robot; without it (or a global start) it does nothing. A drop
  /// of the likelihood replaces some particles by random ones (augmented MCL); when the filter
  /// stays lost, half of the weight goes to as many as a global start has, and the old ones
  /// compete. In the middle of a run what is searched is searched for on.
  void set_free_space(const ReflectionGrid& map);

  /// Another map, in the middle of a run: poses and weights stay, and so does what is believed of
  /// sub-maps that both maps have (PatchStates::adopt); doubts of the pose stay too, and a search
  /// beside it goes on in the new map. Works before a start too. Throws std::invalid_argument for
  /// null, and keeps the map that it had.
  void set_model(std::shared_ptr<const SensorModel> model);

  /// The next usable scan is weighed, whatever the gating says.
  void weigh_next() { must_weigh_ = true; }

  /// One scan. A scan in which no beam says anything (empty, all NaN) only moves the particles and
  /// is counted. The first scan after initialize, and of a new run, carries no motion. Throws
  /// std::logic_error when not initialized. The result is overwritten by the next call. Allocates
  /// nothing once it has seen scans as long and particles as many.
  const LocalizationResult& update(const Observation& observation);

  /// Of the last update.
  [[nodiscard]] const LocalizationResult& result() const { return result_; }
  [[nodiscard]] const ParticleSet& particles() const { return particles_; }
  /// Scans of which nothing was usable so far.
  [[nodiscard]] std::size_t unusable_scans() const { return unusable_scans_; }
  /// Times that odometry moved or turned further than a robot can; that motion was left out.
  [[nodiscard]] std::size_t odometry_jumps() const { return odometry_jumps_; }
  /// What the score was made of at the last weighed scan.
  [[nodiscard]] const ScoreEvidence& score_evidence() const { return score_.evidence(); }
  [[nodiscard]] const LocalizerConfig& config() const { return config_; }

  static constexpr std::size_t kMaxLearnedBytes = std::size_t{32} << 20U;
  /// What the next results depend on besides what the constructor and set_free_space were given
  /// (core/base/state_archive.hpp): about 50 bytes a particle, its beliefs, and what a model that
  /// goes on learning has learned (SensorModel::save_learned). Nothing before a start, and when
  /// the model has learned more than max_learned_bytes. Equal states have equal bytes. O(particles
  /// + what was learned).
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> saved_state(
      std::size_t max_learned_bytes = kMaxLearnedBytes);
  /// Goes on where another localizer with the same config, model, seed and free space was: the next
  /// results are the same to the bit. place: of the bytes, for errors. Throws DamageError for
  /// damaged bytes, InputError for those of another version or of other sub-maps; it is not
  /// initialized then.
  void restore(std::span<const std::uint8_t> state, const std::string& place);

 private:
  /// A filter that looks for the robot beside another one, by the same model, which it leaves as it
  /// is.
  Localizer(const Localizer& beside, std::uint64_t seed);

  template <class Self, class Archive>
  static void state(Self& self, Archive& archive);
  void write_filter(StateWriter& archive);
  void read_filter(StateReader& archive);
  [[nodiscard]] bool fits_map() const;
  [[nodiscard]] Pose2Gaussian watch(const Observation& observation, const Pose2Gaussian& pose,
                                    bool weighed);
  void send_scout(const Observation& observation);
  void adopt_particles(const SensorModel& before);
  void recall_scout();
  [[nodiscard]] bool is_contested() const { return contested_scans_ > 0; }
  [[nodiscard]] bool is_refuted_by_scout(const Pose2& pose) const;
  void take_over();
  void start(std::size_t count);
  [[nodiscard]] std::size_t global_count() const;
  /// Draws `keep` of the particles by their weights and adds random ones. Leaves the weights open.
  void redraw(std::size_t keep, std::size_t added, double offset);
  void search_everywhere();
  void seek(bool keeps_old);
  void find_places();
  [[nodiscard]] Pose2Gaussian judge_places();
  [[nodiscard]] Pose2Gaussian pose_now();
  void fill(ParticleSet& particles, std::size_t begin, StreamId stream) const;
  [[nodiscard]] bool is_due();
  [[nodiscard]] Pose2 motion_since_last(const Observation& observation);
  void follow_motion(const Pose2& moved_before);
  void settle_motion(const Pose2Gaussian& pose);
  /// Several places are possible still.
  [[nodiscard]] bool is_open() const { return is_seeking_ || places_.is_active(); }
  [[nodiscard]] bool is_ambiguous() const { return is_open() || confirmation_.is_pending(); }
  [[nodiscard]] bool is_place_sure() const { return !is_ambiguous() && !is_scattered_; }
  [[nodiscard]] bool is_recovering() const;
  /// How far what was weighed so far lets the pose be believed.
  [[nodiscard]] PoseTrust trust() const;
  void judge(const Scan& judged, const Pose2Gaussian& pose, double likelihood_per_beam);
  [[nodiscard]] double elapsed_s(const PatchStates& states, Stamp now) const;
  [[nodiscard]] const Scan* judged_part(const Scan& scan);
  Pose2Gaussian weigh(const Observation& observation, const Pose2& moved_before);
  void weigh_companions(const Observation& observation, double tempering);
  void roughen_start();
  void resample();
  [[nodiscard]] std::size_t min_while_annealing() const;
  [[nodiscard]] double annealing() const;
  void pool_beliefs();
  [[nodiscard]] double place_probability(const Pose2& pose) const;
  void tell_places(const Pose2& pose);
  const LocalizationResult& make_result(const Pose2Gaussian& pose, bool weighed);

  LocalizerConfig config_;
  std::shared_ptr<SensorModel> own_model_;  // null for a model that does not learn
  std::shared_ptr<const SensorModel> model_;
  std::uint64_t seed_;
  std::shared_ptr<WorkerPool> pool_;  // a scout's too
  FreeSpace free_space_;
  HealthMonitor monitor_;
  PlaceFinder finder_;
  PlaceHypotheses places_;
  StartConfirmation confirmation_;
  PlaceWatch watch_;
  std::unique_ptr<Localizer> scout_;  // while the pose is doubted
  int contested_scans_ = 0;           // on end, by the place that it has found
  bool is_seeking_ = false;           // places are still to be found
  bool is_scattered_ = false;         // it began anywhere, and no search confirms a place
  bool keeps_old_ = false;            // ... beside the one believed so far
  int sought_ = 0;                    // scans
  PoseScore score_;

  ParticleSet particles_;
  ParticleSet resampled_;  // the other half of the double buffer
  std::vector<double> log_likelihood_;
  std::vector<std::uint32_t> drawn_;
  std::vector<std::uint64_t> bins_;
  LocalizationResult result_;

  std::uint64_t start_count_ = 0;  // several starts of one localizer draw different numbers
  std::uint64_t step_ = 0;
  bool is_started_ = false;
  std::size_t max_particles_ = 0;
  int annealed_updates_ = 0;
  std::optional<int> run_;
  OdometryGate odometry_;
  std::optional<Pose2Gaussian> at_reading_;  // the pose when odometry was last heard, if one place
  BeyondMap beyond_;
  bool is_missing_ = false;  // odometry, since then
  bool is_untold_ = false;   // some of the motion since the last weighed scan, for good
  bool is_patched_ = false;  // what odometry tells next has been followed by scans already
  std::optional<Stamp> last_weighed_;
  Pose2 moved_;  // since the last weighed scan
  std::size_t scans_since_weighed_ = 0;
  ScannerTurns turns_;
  CompanionScans companions_;
  bool must_weigh_ = false;
  bool are_beliefs_pooled_ = false;  // in result_.submaps, as of now
  std::size_t unusable_scans_ = 0;
  std::size_t odometry_jumps_ = 0;
};

}  // namespace strata::localization
