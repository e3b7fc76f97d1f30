#include "sim/report/clearance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "engine/collide/depenetration.h"
#include "engine/core/parallel.h"
#include "sim/motion/measure_pose.h"

namespace condyle {
namespace {

constexpr std::size_t run_frames = 8;  // sequential, each query starts from the previous one

bool earlier(const Moment& x, const Moment& y) { return x.time_s < y.time_s; }

/// Adds the moments at which each pair is nearest or deepest, so that its least distance depends on
/// neither frames nor margin. Returns the number of samples taken.
int add_nearest(const MotionSampler& sampler, std::size_t pairs, int threads,
                std::vector<Moment>& all) {
  std::vector<MotionSampler::Nearest> found(pairs);
  parallel_for(pairs, threads, [&](std::size_t p) { found[p] = sampler.nearest(p, all); });
  int samples = 0;
  for (auto& of_pair : found) {
    samples += of_pair.samples;
    for (auto& moment : of_pair.moments) {
      const auto place = std::lower_bound(all.begin(), all.end(), moment, earlier);
      if (place == all.end() || place->time_s != moment.time_s)
        all.insert(place, std::move(moment));
    }
  }
  return samples;
}

/// Results of one frame.
struct Frame {
  Moment moment;
  std::vector<PairMeasure> measures;
  std::vector<bool> teeth;
  std::vector<double> coronoids_mm;
};

/// Finds and measures all frames in parallel.
std::vector<Frame> measure_frames(const std::vector<double>& times, const Scene& scene,
                                  const MotionSampler& sampler, const PairMeasures& measures,
                                  const ToothContacts& teeth, const CoronoidClearance& coronoids,
                                  int threads, const Progress& progress) {
  std::vector<Frame> frames(times.size());
  const auto measure_run = [&](std::size_t first) {
    ContactSet set = scene.contacts.at_rest();
    std::vector<TrianglePair> starts(coronoids.sides().size());
    for (std::size_t f = first; f < std::min(first + run_frames, times.size()); ++f) {
      const BodyPoses at = sampler.poses(times[f]);
      set = scene.contacts.find(at, &set, 1);
      Frame& frame = frames[f];
      frame.moment = {times[f], samples_of(set)};
      for (const auto& pair : set.pairs) frame.measures.push_back(measures.measure(pair, at));
      frame.teeth = teeth.touching_at(set, at);
      for (std::size_t side = 0; side < starts.size(); ++side)
        frame.coronoids_mm.push_back(coronoids.distance_mm(side, at, starts[side]));
    }
  };
  const std::size_t runs = (times.size() + run_frames - 1) / run_frames;
  const auto together = static_cast<std::size_t>(std::max(threads, 1)) * 2;
  for (std::size_t done = 0; done < runs; done += together) {
    parallel_for(std::min(together, runs - done), threads,
                 [&](std::size_t i) { measure_run((done + i) * run_frames); });
    report(progress, "checking", static_cast<double>(done) / static_cast<double>(runs));
  }
  return frames;
}

/// A CSV field, quoted where necessary.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string table_of(const ClearanceCheck& check, const std::vector<Frame>& frames) {
  std::string csv =
      "frame,time_s,opening_mm,a,b,touching,distance_mm,depth_mm,beyond_rest_mm,contacts,"
      "witness_a_x_mm,witness_a_y_mm,witness_a_z_mm,witness_b_x_mm,witness_b_y_mm,witness_b_z_mm,"
      "signed_distance_mm,policy,contact_area_mm2,patches,penetration_volume_mm3,"
      "penetration_volume_error_mm3,side,region_a,region_b\n";
  for (std::size_t f = 0; f < frames.size(); ++f)
    for (std::size_t p = 0; p < check.pairs.size(); ++p) {
      const auto& pair = check.pairs[p];
      const PairSample& sample = frames[f].moment.pairs[p];
      const auto& contact = sample.contact;
      const PairMeasure& measure = frames[f].measures[p];
      const auto &wa = contact.witness_a, &wb = contact.witness_b;
      fmt::format_to(std::back_inserter(csv),
                     "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},", f, check.time_s[f],
                     check.opening_mm[f], cell(pair.a), cell(pair.b), contact.touching ? 1 : 0,
                     contact.touching ? 0 : contact.distance_mm, sample.depth_mm,
                     sample.beyond_rest_mm(), sample.contacts, wa.x(), wa.y(), wa.z(), wb.x(),
                     wb.y(), wb.z(), sample.signed_distance_mm(), policy_name(pair.rule.policy));
      const bool unknown = contact.touching && !measure.volume_known;
      fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{}\n", measure.area_mm2,
                     measure.patches,
                     unknown ? std::string("unknown") : fmt::format("{}", measure.volume_mm3),
                     unknown ? std::string("unknown") : fmt::format("{}", measure.volume_error_mm3),
                     measure.side, cell(measure.region_a), cell(measure.region_b));
    }
  return csv;
}

/// A short translation that separates a part from another it overlaps at rest.
std::optional<Eigen::Vector3d> depenetration(const Scene& scene, const PairContact& rest) {
  const auto mesh = [&](int part) -> const TriMesh& {
    return scene.patient.parts[static_cast<std::size_t>(part)].mesh;
  };
  const CollisionMesh surface_a(mesh(rest.part_a)), surface_b(mesh(rest.part_b));
  const Solid solid_a(mesh(rest.part_a)), solid_b(mesh(rest.part_b));
  const Depenetration out = push_out({surface_a, solid_a}, {}, {surface_b, solid_b}, {});
  if (out.status != Depenetration::Status::found) return std::nullopt;
  return out.length_mm * out.direction;
}

/// A pair's verdict before the motion: names, rule and state at rest.
PairVerdict verdict_at_rest(const Scene& scene, std::size_t p, double margin_mm) {
  const auto& parts = scene.patient.parts;
  const auto& rest = scene.contacts.at_rest().pairs[p];
  PairVerdict pair;
  pair.a = parts[static_cast<std::size_t>(rest.part_a)].name;
  pair.b = parts[static_cast<std::size_t>(rest.part_b)].name;
  pair.rule = scene.contacts.rules()[p];
  if (pair.rule.policy == PairPolicy::forbidden)
    pair.required_mm = pair.rule.margin_mm.value_or(margin_mm);
  if (pair.rule.policy == PairPolicy::guided) pair.required_mm = pair.rule.gap_mm;
  pair.rest_distance_mm = rest.touching ? 0 : rest.distance_mm;
  pair.rest_depth_mm = rest.rest_depth_mm;
  pair.min_distance_mm = std::numeric_limits<double>::infinity();
  pair.max_distance_mm = -1;
  return pair;
}

/// Updates a pair's verdict with its state at one time; times must increase.
void take(PairVerdict& pair, const PairSample& sample, const MotionTime& when, bool& touching) {
  const double distance = sample.contact.touching ? 0 : sample.contact.distance_mm;
  const double beyond = sample.beyond_rest_mm();
  const bool nearest = distance < pair.min_distance_mm;
  const bool deepest = beyond > pair.beyond_rest_mm;
  if (nearest) {
    pair.min_distance_mm = distance;
    pair.min_distance_at = when;
  }
  if (distance > pair.max_distance_mm) {
    pair.max_distance_mm = distance;
    pair.max_distance_at = when;
  }
  if (deepest) {
    pair.beyond_rest_mm = beyond;
    pair.deepest_at = when;
  }
  if (deepest || (nearest && pair.beyond_rest_mm == 0)) {
    pair.worst.when = when;
    pair.worst.sample = sample;
  }
  if (sample.contact.touching && !touching) ++pair.touches;
  touching = sample.contact.touching;
}

}  // namespace

bool ClearanceCheck::violated() const {
  return std::any_of(pairs.begin(), pairs.end(),
                     [](const PairVerdict& pair) { return pair.violated(); });
}

std::size_t ClearanceCheck::widest_frame() const {
  return static_cast<std::size_t>(std::max_element(opening_mm.begin(), opening_mm.end()) -
                                  opening_mm.begin());
}

ClearanceCheck check_clearance(const Scene& scene, const Motion& motion,
                               const CheckSettings& settings, const SimulatorSettings& simulator,
                               const Progress& progress) {
  ClearanceCheck check;
  check.margin_mm = settings.margin_mm;
  const auto& parts = scene.patient.parts;
  const auto& rest_pairs = scene.contacts.at_rest().pairs;
  std::vector<double> reach_mm;
  for (std::size_t p = 0; p < rest_pairs.size(); ++p) {
    check.pairs.push_back(verdict_at_rest(scene, p, settings.margin_mm));
    reach_mm.push_back(rest_pairs[p].touching ? 0 : check.pairs.back().required_mm);
  }

  const MotionSampler sampler(scene, motion, simulator.step_s);
  const PairMeasures measures(scene.patient);
  const ToothContacts teeth(scene.patient);
  const CoronoidClearance coronoids(scene.patient);
  check.time_s = frame_times(motion, settings.sampling);
  auto frames = measure_frames(check.time_s, scene, sampler, measures, teeth, coronoids,
                               simulator.threads, progress);
  for (const double time : check.time_s) {
    const Measures read = measure(scene.patient, sampler.poses(time));
    check.opening_mm.push_back(read.opening_mm);
    check.rotation_deg.push_back(read.rotation_deg);
  }
  report(progress, "checking between frames", 0);
  std::vector<Moment> moments;
  for (const auto& frame : frames) moments.push_back(frame.moment);
  auto between = sampler.between(moments, reach_mm, simulator.threads);
  check.samples_between = static_cast<int>(between.size());
  std::vector<Moment> all;
  std::merge(moments.begin(), moments.end(), between.begin(), between.end(),
             std::back_inserter(all), earlier);
  check.samples_between += add_nearest(sampler, check.pairs.size(), simulator.threads, all);
  const auto when = [&](double time_s) {
    const auto next = std::lower_bound(check.time_s.begin(), check.time_s.end(), time_s);
    const Measures read = measure(scene.patient, sampler.poses(time_s));
    return MotionTime{static_cast<int>(next - check.time_s.begin()),
                      next == check.time_s.end() || *next != time_s, time_s, read.opening_mm,
                      read.rotation_deg};
  };
  std::vector<MotionTime> whens;
  for (const auto& moment : all) whens.push_back(when(moment.time_s));

  parallel_for(check.pairs.size(), simulator.threads, [&](std::size_t p) {
    PairVerdict& pair = check.pairs[p];
    bool touching = false;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const PairSample& sample = all[i].pairs[p];
      if (sample.contact.touching && !pair.first_touch) {
        const bool at_start = i == 0;
        pair.first_touch =
            at_start ? whens[0] : when(sampler.first_touch(p, all[i - 1].time_s, all[i]).time_s);
      }
      take(pair, sample, whens[i], touching);
      if (!whens[i].between) {
        pair.touching_frames += sample.contact.touching;
        pair.clearance_mm.push_back(sample.signed_distance_mm());
      }
    }
    auto& worst = pair.worst;
    worst.poses = sampler.poses(worst.when.time_s);
    worst.measure = worst.when.between
                        ? measures.measure(worst.sample.contact, worst.poses)
                        : frames[static_cast<std::size_t>(worst.when.frame)].measures[p];
    apply_rule(pair, simulator.contact.slack_mm);
    const auto& rest = rest_pairs[p];
    const bool roams =
        scene.patient.bodies.roams(parts[static_cast<std::size_t>(rest.part_b)].body);
    if (roams && pair.at_rest && pair.rest_depth_mm > 0)
      pair.push_out_mm = depenetration(scene, rest);
  });

  check.coronoids = coronoids.sides();
  check.coronoids_missing = coronoids.missing();
  for (std::size_t side = 0; side < check.coronoids.size(); ++side)
    for (const auto& frame : frames) check.coronoids[side].mm.push_back(frame.coronoids_mm[side]);
  std::vector<std::vector<bool>> touching_teeth;
  for (const auto& frame : frames) touching_teeth.push_back(frame.teeth);
  check.teeth = tooth_use(teeth.teeth(), touching_teeth);
  check.pairs_csv = table_of(check, frames);
  report(progress, "checking", 1);
  return check;
}

}  // namespace condyle
