#include "sim/dynamics/rest.h"

#include <algorithm>

namespace condyle {

Rest run_to_rest(RigidWorld& world, std::span<const int> bodies, const RestSettings& settings,
                 int threads, const Progress& progress) {
  // of a jaw; smaller pieces are held to a stricter limit than requested
  constexpr double radius_mm = 50;
  Rest rest;
  constexpr int report_every_steps = 25;  // steps between reports of progress
  int steps = 0;
  double still_s = 0;
  while (rest.seconds < settings.longest_s && still_s < settings.still_for_s) {
    if (steps++ % report_every_steps == 0)
      report(progress, "releasing", rest.seconds / settings.longest_s);
    const auto step = world.step(threads);
    if (!step.taken) return rest;
    rest.seconds += world.settings().step_s;
    rest.depth_mm = step.depth_mm;
    const bool still = std::all_of(bodies.begin(), bodies.end(), [&](int body) {
      const RigidMotion& motion = world.motion(body);
      return motion.velocity.norm() + radius_mm * motion.spin.norm() < settings.still_mm_s;
    });
    still_s = still && !world.contacts().empty() ? still_s + world.settings().step_s : 0;
  }
  rest.reached = still_s >= settings.still_for_s;
  return rest;
}

Rest run_to_rest(RigidWorld& world, int body, const RestSettings& settings, int threads) {
  return run_to_rest(world, std::span(&body, 1), settings, threads);
}

}  // namespace condyle
