// SPDX-License-Identifier: Apache-2.0
/// example::ObstacleAlarm: a component outside Strata's tree, loaded by its library's name.
///
/// In: scan. Out: closest_obstacle, the closest point that the scanner saw, whenever it is nearer
/// than alarm_distance_m, and alarm, the same in words. At the end of a replay: obstacle_alarm.json
/// beside what others save.
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include <strata/base/error.hpp>
#include <strata/runtime/component_library.hpp>

namespace example {

struct ObstacleAlarmConfig {
  double alarm_distance_m = 0.5;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("alarm_distance_m", c.alarm_distance_m,
            {.doc = "obstacles nearer than this are told", .unit = "m", .min = 0.0, .max = 10.0});
  }
};

class ObstacleAlarm final : public strata::runtime::Component {
 public:
  using Component::Component;

 private:
  // Its parameters can be listed and set before a lifecycle manager has configured it.
  void on_declare() override { declare_parameters<ObstacleAlarmConfig>(); }

  void on_configure() override {
    config_ = read_parameters<ObstacleAlarmConfig>();
    keep_live(config_, {"alarm_distance_m"});  // may be set while it runs: ros2 param set
    publish_ = advertise<geometry_msgs::msg::PointStamped>("closest_obstacle", "default");
    publish_text_ = advertise<std_msgs::msg::String>("alarm", "default");
    subscribe<sensor_msgs::msg::LaserScan>("scan", "sensor_data",
                                           [this](const auto& scan) { on_scan(scan); });
  }

  void on_scan(const sensor_msgs::msg::LaserScan& scan) {
    ++scans_;
    std::optional<std::size_t> closest;
    for (std::size_t i = 0; i < scan.ranges().size(); ++i) {
      const float range_m = scan.ranges()[i];
      // Also false for NaN, which scanners send for beams without an echo.
      if (!(range_m >= scan.range_min() && range_m <= scan.range_max())) continue;
      if (!closest || range_m < scan.ranges()[*closest]) closest = i;
    }
    if (!closest || scan.ranges()[*closest] >= config_.alarm_distance_m) return;
    ++alarms_;
    const double range_m = scan.ranges()[*closest];
    const double bearing_rad =
        scan.angle_min() + static_cast<double>(*closest) * scan.angle_increment();
    geometry_msgs::msg::PointStamped message;
    message.header(scan.header());
    message.point().x(range_m * std::cos(bearing_rad));
    message.point().y(range_m * std::sin(bearing_rad));
    publish_(message);
    std_msgs::msg::String text;
    text.data(std::to_string(range_m) + " m away");
    publish_text_(text);
  }

  void on_diagnose(strata::runtime::Health& health) const override {
    health.add("scans", scans_);
    health.add("alarms", alarms_);
  }

  void on_finish(const std::filesystem::path& out_dir) override {
    const std::filesystem::path file = out_dir / "obstacle_alarm.json";
    std::ofstream out(file);
    out << "{\"scans\": " << scans_ << ", \"alarms\": " << alarms_ << "}\n";
    if (!out.flush()) {
      throw strata::OutputError(file.string(), "cannot be written", "free some space");
    }
  }

  ObstacleAlarmConfig config_;
  std::uint64_t scans_ = 0;
  std::uint64_t alarms_ = 0;
  std::function<void(const geometry_msgs::msg::PointStamped&)> publish_;
  std::function<void(const std_msgs::msg::String&)> publish_text_;
};

}  // namespace example

STRATA_COMPONENT_LIBRARY(registry) {
  registry.add<example::ObstacleAlarm>("example::ObstacleAlarm");
}
