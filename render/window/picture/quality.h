#pragma once

namespace condyle {

/// Quality of a picture.
struct Quality {
  double render_scale = 1;  // of each side; 0.66 to 1, and 0.4 where that is far too slow
  int samples = 4;
  bool shadows = true;
  bool coarse = false;  // see PictureSettings
  bool operator==(const Quality&) const = default;
};

/// Lowers the quality of moving pictures on a slow driver, so that they stay fluent; never that of
/// the simulation. At rest the picture always has full quality.
class QualityGovernor {
 public:
  /// Best picture when nothing moves, else the best that has kept to the target time so far.
  Quality choose(bool moving) const;

  /// Reports the duration of the last picture, ms.
  void measured(bool moving, double picture_ms);

  /// Reports the number of steps per second that the simulation can take.
  void simulated(double steps_per_second);
  /// Minimum interval between pictures of a playing motion, s: above 0 where the simulation needs
  /// the time.
  double min_interval_s() const { return yields_ ? yielding_interval_s : 0; }

  static constexpr double yielding_interval_s = 1.0 / 16;

 private:
  bool yields_ = false;
  int level_ = 0;            // of the moving picture; 0 is the best
  bool known_ = false;       // whether any picture was measured
  int slow_ = 0, fast_ = 0;  // pictures in a row
};

}  // namespace condyle
